//! Settings of a thickening: thickness, side, voxel size.

use super::ThickenSettingsError;
use crate::geom::aabb::Aabb;
use crate::mesh::{LENGTHS, TriMesh};
use crate::quantity::{Length, MAX_LATTICE_INDEX, Precision, VoxelSize};
use glam::DVec3;

/// Side of the patch on which the solid lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PatchSide {
    /// Behind the patch: opposite to its normals.
    #[default]
    Inner,
    /// In front of the patch: where its normals point.
    Outer,
}

/// Normals of the section that shape processing works with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SectionNormals {
    /// Normals of the walls that stand on the boundary's edges: in the plane of the edge's
    /// triangle, across the edge.
    #[default]
    Exact,
    /// Normals of the contour's faces, smoothed in each round (\[WC13\] section 4.3, which does not
    /// know the walls). The section gets rounder where the boundary is jagged.
    Smoothed,
}

/// Settings of [`thicken`](super::thicken).
#[derive(Clone, Debug, PartialEq)]
pub struct ThickenSettings {
    /// Thickness r of the solid, positive.
    pub thickness: Length,
    /// Thickness at each vertex of the patch, instead of `thickness`; in model units, all positive.
    ///
    /// The map is interpolated over the triangles. A point of the solid is at most as deep as the
    /// thickness at its closest point of the patch.
    pub thickness_map: Option<Vec<f64>>,
    /// Side of the patch on which the solid lies.
    pub side: PatchSide,
    /// Voxel size, less than r/2 (\[WC13\] Remark 1); `None` for r/4.
    ///
    /// With a resolution N, h = (longest side of the patch's bounding box + 2 r) / N.
    pub voxel: Option<VoxelSize>,
    /// Maximum number of times that the voxel size is halved where the lattice is too coarse for
    /// the patch. Each time takes four times as long.
    pub max_halvings: u32,
    /// Maximum number of rounds of shape processing (\[WC13\] section 4.3, which makes 10 to 20);
    /// 0 leaves the contour as it is.
    pub rounds: u32,
    /// Normals of the section in shape processing.
    pub section_normals: SectionNormals,
    /// Precision of the result's coordinates.
    pub precision: Precision,
    /// Maximum memory in bytes; `None` for what the system has available. A run that would need
    /// more is refused before it starts.
    pub max_memory: Option<u64>,
}

impl Default for ThickenSettings {
    fn default() -> Self {
        ThickenSettings {
            thickness: Length::DiagonalFraction(0.02),
            thickness_map: None,
            side: PatchSide::Inner,
            voxel: None,
            max_halvings: 1,
            rounds: DEFAULT_ROUNDS,
            section_normals: SectionNormals::Exact,
            precision: Precision::F32,
            max_memory: None,
        }
    }
}

/// Thickness and voxel size in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ModelUnits {
    /// The thickness, or the largest one of a map.
    pub thickness: f64,
    /// The voxel size.
    pub voxel: f64,
}

/// Default number of rounds of shape processing. A quarter of the way in each leaves 6% after ten.
const DEFAULT_ROUNDS: u32 = 10;

/// Default number of voxels per thickness: twice the minimum of \[WC13\] Remark 1.
const VOXELS_PER_THICKNESS: f64 = 4.0;

impl ThickenSettings {
    /// Checks what can be checked without a patch.
    ///
    /// # Errors
    /// The first setting that makes no sense.
    pub fn validate(&self) -> Result<(), ThickenSettingsError> {
        let (Length::Units(thickness) | Length::DiagonalFraction(thickness)) = self.thickness;
        check_thickness(thickness)?;
        match self.voxel {
            Some(VoxelSize::Units(h)) => check_voxel(h),
            Some(VoxelSize::Resolution(0)) => Err(ThickenSettingsError::Resolution),
            Some(VoxelSize::Resolution(_)) | None => Ok(()),
        }
    }

    /// Converts thickness and voxel size to model units for `patch`.
    pub(super) fn in_model_units(&self, patch: &TriMesh) -> Result<ModelUnits, ThickenSettingsError> {
        self.validate()?;
        let bounds = Aabb::around(patch.vertices.iter().map(|&v| DVec3::from(v)));
        let [thinnest, thickness] = match (&self.thickness_map, self.thickness) {
            (Some(map), _) => {
                if map.len() != patch.vertices.len() {
                    return Err(ThickenSettingsError::Map {
                        values: map.len(),
                        vertices: patch.vertices.len(),
                    });
                }
                map.iter().try_for_each(|&r| check_thickness(r))?;
                [f64::min, f64::max].map(|f| map.iter().copied().reduce(f).unwrap_or(0.0))
            }
            (None, Length::Units(r)) => [r; 2],
            (None, Length::DiagonalFraction(fraction)) => [fraction * bounds.diagonal(); 2],
        };
        check_thickness(thinnest)?;
        let voxel = match self.voxel {
            None => thinnest / VOXELS_PER_THICKNESS,
            Some(VoxelSize::Units(h)) => h,
            Some(VoxelSize::Resolution(n)) => (bounds.size().max_element() + 2.0 * thickness) / f64::from(n),
        };
        check_voxel(voxel)?;
        if voxel >= 0.5 * thinnest {
            return Err(ThickenSettingsError::TooCoarse { voxel, thickness: thinnest });
        }
        let farthest = bounds.lo.abs().max(bounds.hi.abs()).max_element() + 2.0 * thickness;
        if !LENGTHS.contains(&voxel) {
            return Err(ThickenSettingsError::Length { what: "voxel size", length: voxel });
        }
        if farthest > *LENGTHS.end() {
            return Err(ThickenSettingsError::Length { what: "thickness", length: thickness });
        }
        if farthest / voxel > MAX_LATTICE_INDEX {
            return Err(ThickenSettingsError::Range { voxel, smallest: farthest / MAX_LATTICE_INDEX });
        }
        Ok(ModelUnits { thickness, voxel })
    }
}

fn check_thickness(thickness: f64) -> Result<(), ThickenSettingsError> {
    if thickness > 0.0 && thickness.is_finite() {
        Ok(())
    } else {
        Err(ThickenSettingsError::Thickness(thickness))
    }
}

fn check_voxel(voxel: f64) -> Result<(), ThickenSettingsError> {
    if voxel > 0.0 && voxel.is_finite() { Ok(()) } else { Err(ThickenSettingsError::Voxel(voxel)) }
}
