//! What to make: distance, voxel size, sign mode.

use crate::band::BandSettings;
use crate::contour::{ContourSettings, Precision};
use crate::geom::aabb::Aabb;
use crate::lattice::{Lattice, Slab};
use crate::mesh::{LENGTHS, TriMesh};
use glam::DVec3;

/// A length given by a user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// In model units.
    Units(f64),
    /// As a fraction of the diagonal of the input's bounding box: 0.02 is two percent.
    OfDiagonal(f64),
}

/// How fine the lattice is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum VoxelSize {
    /// The width h of a cell, in model units.
    Units(f64),
    /// h = (longest side of the input's bounding box + 2 max(r, 0)) / N.
    Resolution(u32),
}

/// How far the result may be from the true offset surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// In model units.
    Units(f64),
    /// In voxels.
    Voxels(f64),
}

/// Where the sign of the distance comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SignMode {
    /// By the angle-weighted pseudonormal; the input must be closed and consistently oriented.
    #[default]
    Closed,
    /// By the angle-weighted pseudonormal, whatever the input is. Where the sign jumps far from the
    /// surface, the result is closed there.
    Pseudonormal,
}

/// What to make.
#[derive(Clone, Debug, PartialEq)]
pub struct OffsetSettings {
    /// Signed distance r: positive grows, negative shrinks, 0 remeshes.
    pub distance: Length,
    /// Voxel size.
    pub voxel: VoxelSize,
    /// Sign mode.
    pub sign: SignMode,
    /// Half-width of the stored band in voxels, 1 to 1000. Contouring needs 1, a level set for other
    /// programs 3.
    pub half_width: f64,
    /// Keep the narrow band, in OpenVDB grids. Without, it is gone when the mesh is done.
    pub keep_band: bool,
    /// Keep with the band, where it is kept, the closest triangle of each of its voxels: a second grid, of
    /// integers, which many programs cannot read. Without, no closest triangles are stored.
    pub keep_closest: bool,
    /// Coordinates of the result.
    pub precision: Precision,
    /// Refine the result until it is this near to the true offset surface; `None` leaves it as the lattice
    /// gives it. What could not be reached is counted in
    /// [`ContourStatistics::beyond_tolerance`](crate::contour::ContourStatistics).
    pub tolerance: Option<Tolerance>,
    /// How often the voxel size may be halved where the lattice does not see all of the surface
    /// ([`MissedFeatures`](crate::subvoxel::MissedFeatures)); 0 leaves it as it is. The whole lattice is refined.
    pub resolve: u32,
    /// Refuse the lattice when the whole program would need more than about this many bytes; `None` for the memory
    /// that the system has available.
    pub max_memory: Option<u64>,
}

impl Default for OffsetSettings {
    fn default() -> Self {
        OffsetSettings {
            distance: Length::OfDiagonal(0.02),
            voxel: VoxelSize::Resolution(256),
            sign: SignMode::Closed,
            half_width: 1.0,
            keep_band: false,
            keep_closest: false,
            precision: Precision::F32,
            tolerance: None,
            resolve: 0,
            max_memory: None,
        }
    }
}

/// Settings that make no sense.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SettingsError {
    /// The distance is infinite or not a number.
    #[error("the distance must be a finite number, not {0}")]
    Distance(f64),
    /// The voxel size is zero, negative, infinite or not a number.
    #[error("the voxel size must be a positive number, not {0}")]
    Voxel(f64),
    /// The resolution is zero.
    #[error("the resolution must be at least 1")]
    Resolution,
    /// The tolerance is zero, negative, infinite or not a number.
    #[error("the tolerance must be a positive number, not {0}")]
    Tolerance(f64),
    /// The tolerance is less than what coordinates can hold.
    #[error(
        "the tolerance {tolerance:.3e} is finer than coordinates of {bits} bits are at the far end of the result; \
         choose one of at least {smallest:.3e}, or move the model towards the origin"
    )]
    FineTolerance {
        /// The tolerance in model units.
        tolerance: f64,
        /// The bits of a coordinate.
        bits: u32,
        /// The smallest tolerance in model units that is taken.
        smallest: f64,
    },
    /// The half-width is out of range.
    #[error("the half-width must be 1 to 1000 voxels, not {0}")]
    HalfWidth(f64),
    /// A length is too large or too small to work with ([`LENGTHS`]).
    #[error("the {what} is {length:e}, and lengths from {:e} to {:e} can be worked with; choose another one", LENGTHS.start(), LENGTHS.end())]
    Length {
        /// Which length.
        what: &'static str,
        /// The length.
        length: f64,
    },
    /// Lattice indices would leave the range of 32-bit integers.
    #[error(
        "with voxel size {voxel} the model and its offset span more than 2^30 lattice indices from the \
         origin; choose a voxel size of at least {smallest}, or move the model towards the origin"
    )]
    Range {
        /// The voxel size.
        voxel: f64,
        /// The smallest voxel size that works.
        smallest: f64,
    },
}

/// The largest lattice index: a leaf or a bounding box beyond it must still fit into an i32.
const LARGEST_INDEX: f64 = (1 << 30) as f64;

/// Steps of 64-bit coordinates that a tolerance spans at least: distances are computed in as many bits, and
/// lose some. Below, all triangles are split as often as they may be, plane ones too, and none comes nearer.
const STEPS_OF_F64: f64 = 8.0;

impl OffsetSettings {
    /// Checks what can be checked without a mesh.
    ///
    /// # Errors
    /// The first setting that makes no sense.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let (Length::Units(distance) | Length::OfDiagonal(distance)) = self.distance;
        if !distance.is_finite() {
            return Err(SettingsError::Distance(distance));
        }
        match self.voxel {
            VoxelSize::Units(h) if !(h > 0.0 && h.is_finite()) => return Err(SettingsError::Voxel(h)),
            VoxelSize::Resolution(0) => return Err(SettingsError::Resolution),
            VoxelSize::Units(_) | VoxelSize::Resolution(_) => {}
        }
        if let Some(Tolerance::Units(t) | Tolerance::Voxels(t)) = self.tolerance
            && !(t > 0.0 && t.is_finite())
        {
            return Err(SettingsError::Tolerance(t));
        }
        if !(1.0..=1000.0).contains(&self.half_width) {
            return Err(SettingsError::HalfWidth(self.half_width));
        }
        Ok(())
    }

    /// The settings in model units for `mesh`.
    ///
    /// # Errors
    /// The first setting that makes no sense, or not for this mesh.
    pub fn resolve(&self, mesh: &TriMesh) -> Result<BandSettings, SettingsError> {
        self.validate()?;
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let r = match self.distance {
            Length::Units(r) => r,
            Length::OfDiagonal(fraction) => fraction * bounds.diagonal(),
        };
        if !r.is_finite() {
            return Err(SettingsError::Distance(r));
        }
        let voxel = match self.voxel {
            VoxelSize::Units(h) => h,
            VoxelSize::Resolution(n) => (bounds.size().max_element() + 2.0 * r.max(0.0)) / f64::from(n),
        };
        if !(voxel > 0.0 && voxel.is_finite()) {
            return Err(SettingsError::Voxel(voxel));
        }
        let band =
            BandSettings { lattice: Lattice { voxel }, r, half_width: self.half_width, slab: Slab::WHOLE };
        self.check_range(mesh, &band)?;
        Ok(band)
    }

    /// Checks that the lattice's indices are in range, and the tolerance is one that coordinates can keep.
    pub(super) fn check_range(&self, mesh: &TriMesh, band: &BandSettings) -> Result<(), SettingsError> {
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let (voxel, r) = (band.lattice.voxel, band.r);
        let farthest = bounds.lo.abs().max(bounds.hi.abs()).max_element() + r.abs() + self.half_width * voxel;
        if !LENGTHS.contains(&voxel) {
            return Err(SettingsError::Length { what: "voxel size", length: voxel });
        }
        if farthest > *LENGTHS.end() {
            return Err(SettingsError::Length { what: "distance", length: r.abs() });
        }
        if farthest / voxel > LARGEST_INDEX {
            return Err(SettingsError::Range { voxel, smallest: farthest / LARGEST_INDEX });
        }
        let (bits, step) = match self.precision {
            Precision::F32 => (32, f64::from(f32::EPSILON)),
            Precision::F64 => (64, STEPS_OF_F64 * f64::EPSILON),
        };
        let smallest = step * farthest;
        match self.tolerance {
            Some(Tolerance::Units(tolerance)) if tolerance < smallest => {
                Err(SettingsError::FineTolerance { tolerance, bits, smallest })
            }
            Some(Tolerance::Voxels(t)) if t * voxel < smallest => {
                Err(SettingsError::FineTolerance { tolerance: t * voxel, bits, smallest })
            }
            _ => Ok(()),
        }
    }

    /// The settings of the contour on a lattice.
    pub(super) fn contour(&self, lattice: Lattice) -> ContourSettings {
        let tolerance = self.tolerance.map(|tolerance| match tolerance {
            Tolerance::Units(t) => t / lattice.voxel,
            Tolerance::Voxels(t) => t,
        });
        ContourSettings { precision: self.precision, tolerance, ..ContourSettings::default() }
    }
}
