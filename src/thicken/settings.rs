//! What to make: thickness, side, voxel size.

use super::ThickenError;
use crate::contour::Precision;
use crate::geom::aabb::Aabb;
use crate::mesh::{LENGTHS, TriMesh};
use crate::offset::{Length, VoxelSize};
use glam::DVec3;

/// The side of the patch on which the solid lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Behind the patch: opposite to its normals.
    #[default]
    Inner,
    /// In front of it.
    Outer,
}

/// The normals of the section in shape processing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SectionNormals {
    /// Those of the walls that stand on the boundary's edges: in the plane of the triangle, across the edge.
    #[default]
    Exact,
    /// Those of the faces, smoothed in each round (\[WC13\] section 4.3, which does not know the walls): rounder where the
    /// boundary is jagged.
    Smoothed,
}

/// What to make.
#[derive(Clone, Debug, PartialEq)]
pub struct ThickenSettings {
    /// Thickness r of the solid, positive.
    pub thickness: Length,
    /// Instead of that, the thickness at each vertex of the patch, in model units, all positive. It is interpolated over the
    /// triangles, and each point of the solid is as deep as the thickness at its closest point allows.
    pub map: Option<Vec<f64>>,
    /// The side of the patch on which it lies.
    pub side: Side,
    /// Voxel size, less than r/2 (\[WC13\] Remark 1); `None` for r/4.
    /// With a resolution N, h = (longest side of the patch's bounding box + 2 r) / N.
    pub voxel: Option<VoxelSize>,
    /// How often the voxel size may be halved where the lattice is too coarse for the patch. Each time takes four times as
    /// long.
    pub halvings: u32,
    /// Rounds of shape processing at most (\[WC13\] section 4.3, which makes 10 to 20); 0 leaves the contour as it is.
    pub rounds: u32,
    /// Which normals the section has in them.
    pub section_normals: SectionNormals,
    /// Coordinates of the result.
    pub precision: Precision,
    /// Refuse to start what would need more memory than this, in bytes; `None` for what the system has available.
    pub max_memory: Option<u64>,
}

impl Default for ThickenSettings {
    fn default() -> Self {
        ThickenSettings {
            thickness: Length::OfDiagonal(0.02),
            map: None,
            side: Side::Inner,
            voxel: None,
            halvings: 1,
            rounds: ROUNDS,
            section_normals: SectionNormals::Exact,
            precision: Precision::F32,
            max_memory: None,
        }
    }
}

/// The settings in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Resolved {
    /// The largest thickness.
    pub thickness: f64,
    pub voxel: f64,
}

/// Rounds of shape processing when nothing else is said. A quarter of the way in each leaves 6% after ten.
pub(crate) const ROUNDS: u32 = 10;

/// Voxels per thickness when nothing else is said: twice what \[WC13\] Remark 1 asks for at least.
const VOXELS_PER_THICKNESS: f64 = 4.0;

/// The largest lattice index: a leaf beyond it must still fit into an i32.
const LARGEST_INDEX: f64 = (1 << 30) as f64;

impl ThickenSettings {
    /// Checks what can be checked without a mesh.
    ///
    /// # Errors
    /// The first setting that makes no sense.
    pub fn validate(&self) -> Result<(), ThickenError> {
        let (Length::Units(thickness) | Length::OfDiagonal(thickness)) = self.thickness;
        check_thickness(thickness)?;
        match self.voxel {
            Some(VoxelSize::Units(h)) => check_voxel(h),
            Some(VoxelSize::Resolution(0)) => Err(ThickenError::Resolution),
            Some(VoxelSize::Resolution(_)) | None => Ok(()),
        }
    }

    /// The settings in model units for `mesh`.
    pub(super) fn resolve(&self, mesh: &TriMesh) -> Result<Resolved, ThickenError> {
        self.validate()?;
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let [thinnest, thickness] = match (&self.map, self.thickness) {
            (Some(map), _) => {
                if map.len() != mesh.vertices.len() {
                    return Err(ThickenError::Map { values: map.len(), vertices: mesh.vertices.len() });
                }
                map.iter().try_for_each(|&r| check_thickness(r))?;
                let [least, most] =
                    [f64::min, f64::max].map(|f| map.iter().copied().reduce(f).unwrap_or(0.0));
                [least, most]
            }
            (None, Length::Units(r)) => [r; 2],
            (None, Length::OfDiagonal(fraction)) => [fraction * bounds.diagonal(); 2],
        };
        check_thickness(thinnest)?;
        let voxel = match self.voxel {
            None => thinnest / VOXELS_PER_THICKNESS,
            Some(VoxelSize::Units(h)) => h,
            Some(VoxelSize::Resolution(n)) => (bounds.size().max_element() + 2.0 * thickness) / f64::from(n),
        };
        check_voxel(voxel)?;
        if voxel >= 0.5 * thinnest {
            return Err(ThickenError::TooCoarse { voxel, thickness: thinnest });
        }
        let farthest = bounds.lo.abs().max(bounds.hi.abs()).max_element() + 2.0 * thickness;
        if !LENGTHS.contains(&voxel) {
            return Err(ThickenError::Length { what: "voxel size", length: voxel });
        }
        if farthest > *LENGTHS.end() {
            return Err(ThickenError::Length { what: "thickness", length: thickness });
        }
        if farthest / voxel > LARGEST_INDEX {
            return Err(ThickenError::Range { voxel, smallest: farthest / LARGEST_INDEX });
        }
        Ok(Resolved { thickness, voxel })
    }
}

fn check_thickness(thickness: f64) -> Result<(), ThickenError> {
    if thickness > 0.0 && thickness.is_finite() { Ok(()) } else { Err(ThickenError::Thickness(thickness)) }
}

fn check_voxel(voxel: f64) -> Result<(), ThickenError> {
    if voxel > 0.0 && voxel.is_finite() { Ok(()) } else { Err(ThickenError::Voxel(voxel)) }
}
