//! The settings of an offset, and their values in model units for a mesh.

use crate::band::BandSettings;
use crate::contour::ContourSettings;
use crate::geom::aabb::Aabb;
use crate::lattice::{Lattice, Slab};
use crate::mesh::{LENGTHS, TriMesh};
use crate::quantity::{Length, MAX_LATTICE_INDEX, Precision, Tolerance, VoxelSize};
use glam::DVec3;

/// The answer to an input that is not the boundary of a solid.
///
/// The sign of the distance comes from angle-weighted pseudonormals either way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum OpenInput {
    /// Inputs that are not closed and consistently oriented are refused.
    #[default]
    Refuse,
    /// Inputs are taken as they are. Where the sign jumps far from the surface, the result is
    /// closed there.
    Accept,
}

/// The part of the narrow band that is kept in OpenVDB grids.
#[cfg(feature = "openvdb")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BandOptions {
    /// Half-width of the band in voxels, 1 to 1000. OpenVDB's level-set tools expect 3.
    pub half_width: f64,
    /// Whether the closest triangle of each voxel is kept, too: a second grid, of integers, which
    /// many programs cannot read.
    pub closest: bool,
}

#[cfg(feature = "openvdb")]
impl Default for BandOptions {
    fn default() -> Self {
        BandOptions { half_width: 3.0, closest: false }
    }
}

/// The geometry of an offset: distance, fineness, and what is made.
///
/// ```
/// use exocarp::{Length, OffsetSettings, VoxelSize};
///
/// let shrunk = OffsetSettings {
///     distance: Length::DiagonalFraction(-0.02),
///     voxel: VoxelSize::Resolution(512),
///     ..OffsetSettings::default()
/// };
/// assert!(shrunk.validate().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct OffsetSettings {
    /// Signed distance r: positive grows, negative shrinks, 0 remeshes.
    pub distance: Length,
    /// Voxel size.
    pub voxel: VoxelSize,
    /// The answer to an input that is not the boundary of a solid.
    pub open_input: OpenInput,
    /// The part of the narrow band that is kept beside the mesh. Without it the band is as narrow
    /// as contouring needs, 1 voxel on either side, and is gone when the mesh is done.
    #[cfg(feature = "openvdb")]
    pub band: Option<BandOptions>,
    /// Coordinates of the result.
    pub precision: Precision,
    /// The distance from the true offset surface to which the result is refined; `None` leaves it
    /// as the lattice gives it. What could not be reached is counted in
    /// `beyond_tolerance` of the contour's statistics.
    pub tolerance: Option<Tolerance>,
    /// The number of times that the voxel size may be halved where the lattice does not see all of
    /// the surface ([`MissedFeatures`](crate::MissedFeatures)); 0 leaves it as it is. The whole
    /// lattice is refined.
    pub max_halvings: u32,
    /// The most memory in bytes that the whole program may need, about; more is refused. `None`
    /// for the memory that the system has available.
    pub max_memory: Option<u64>,
}

impl Default for OffsetSettings {
    fn default() -> Self {
        OffsetSettings {
            distance: Length::DiagonalFraction(0.02),
            voxel: VoxelSize::Resolution(256),
            open_input: OpenInput::Refuse,
            #[cfg(feature = "openvdb")]
            band: None,
            precision: Precision::F32,
            tolerance: None,
            max_halvings: 0,
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
        /// Name of the length.
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

/// Steps of 64-bit coordinates that a tolerance spans at least: distances are computed in as many
/// bits, and lose some. Below, all triangles are split as often as they may be, plane ones too, and
/// none comes nearer.
const STEPS_OF_F64: f64 = 8.0;

impl OffsetSettings {
    /// Checks what can be checked without a mesh.
    ///
    /// # Errors
    /// The first setting that makes no sense.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let (Length::Units(distance) | Length::DiagonalFraction(distance)) = self.distance;
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
        let half_width = self.half_width();
        if !(1.0..=1000.0).contains(&half_width) {
            return Err(SettingsError::HalfWidth(half_width));
        }
        Ok(())
    }

    /// Returns the half-width of the band in voxels: contouring needs 1.
    pub(crate) fn half_width(&self) -> f64 {
        const LEAST: f64 = 1.0;
        #[cfg(feature = "openvdb")]
        let half_width = self.band.map_or(LEAST, |band| band.half_width);
        #[cfg(not(feature = "openvdb"))]
        let half_width = LEAST;
        half_width
    }

    /// Returns the settings in model units for `mesh`.
    ///
    /// # Errors
    /// The first setting that makes no sense, or not for this mesh.
    pub(crate) fn in_model_units(&self, mesh: &TriMesh) -> Result<BandSettings, SettingsError> {
        self.validate()?;
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let r = match self.distance {
            Length::Units(r) => r,
            Length::DiagonalFraction(fraction) => fraction * bounds.diagonal(),
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
            BandSettings { lattice: Lattice { voxel }, r, half_width: self.half_width(), slab: Slab::WHOLE };
        self.check_range(mesh, &band)?;
        Ok(band)
    }

    /// Checks that the lattice's indices are in range, and the tolerance is one that coordinates
    /// can keep.
    pub(super) fn check_range(&self, mesh: &TriMesh, band: &BandSettings) -> Result<(), SettingsError> {
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let (voxel, r) = (band.lattice.voxel, band.r);
        let farthest =
            bounds.lo.abs().max(bounds.hi.abs()).max_element() + r.abs() + self.half_width() * voxel;
        if !LENGTHS.contains(&voxel) {
            return Err(SettingsError::Length { what: "voxel size", length: voxel });
        }
        if farthest > *LENGTHS.end() {
            return Err(SettingsError::Length { what: "distance", length: r.abs() });
        }
        if farthest / voxel > MAX_LATTICE_INDEX {
            return Err(SettingsError::Range { voxel, smallest: farthest / MAX_LATTICE_INDEX });
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
