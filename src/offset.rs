//! The recipe: from a mesh and a distance to the offset surface and its narrow band.

use crate::error::Error;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use serde::Serialize;

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

/// The coordinates that the result is decided on and written with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Every coordinate is a 32-bit float: right for binary STL and PLY.
    #[default]
    F32,
    /// 64-bit floats: right for text formats and `--f64` PLY.
    F64,
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
    /// Half width of the stored band in voxels, at least 1. Contouring needs 1, a level set for other
    /// programs 3.
    pub half_width: f64,
    /// Coordinates of the result.
    pub precision: Precision,
    /// Refuse to start when the band would need more than this many bytes.
    pub max_memory: Option<u64>,
}

impl Default for OffsetSettings {
    fn default() -> Self {
        OffsetSettings {
            distance: Length::OfDiagonal(0.02),
            voxel: VoxelSize::Resolution(256),
            sign: SignMode::Closed,
            half_width: 1.0,
            precision: Precision::F32,
            max_memory: None,
        }
    }
}

/// What [`offset`] returns.
#[derive(Debug)]
pub struct OffsetResult {
    /// The offset surface: closed, 2-manifold, free of intersections.
    pub mesh: TriMesh,
    /// What happened on the way.
    pub statistics: OffsetStatistics,
}

/// Counts and times of one offset. Serialises to the parts of the statistics file that the engine knows.
#[derive(Clone, Debug, Default, Serialize)]
pub struct OffsetStatistics {
    /// The signed distance in model units.
    pub distance: f64,
    /// The voxel size in model units.
    pub voxel: f64,
    /// Seconds per stage of the engine.
    pub times: EngineTimes,
}

/// Seconds per stage of the engine.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct EngineTimes {
    /// Building the hierarchy.
    pub hierarchy: f64,
    /// Filters and band.
    pub band: f64,
    /// Edge intersections.
    pub edges: f64,
    /// Contouring.
    pub contour: f64,
}

/// The offset surface of `mesh`.
///
/// # Errors
/// Bad settings, unsuitable input, an empty result, a limit, or cancellation.
pub fn offset(mesh: &TriMesh, settings: &OffsetSettings, run: &RunSettings) -> Result<OffsetResult, Error> {
    let _ = (mesh, settings);
    run.check()?;
    unimplemented!("being written")
}
