//! Failures of the contour.

use crate::quantity::Precision;
use crate::run::Cancelled;

/// Why contouring failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContourError {
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The result has too many vertices.
    #[error(transparent)]
    TooManyVertices(#[from] TooManyVertices),
    /// The coordinates of the chosen precision are too coarse for the voxel size.
    #[error(
        "coordinates of size {far} are too coarse in {precision:?} for voxels of size {voxel}; \
         choose 64-bit coordinates, larger voxels, or move the model to the origin"
    )]
    TooFarFromOrigin {
        /// The largest coordinate, in model units.
        far: f64,
        /// The voxel size, in model units.
        voxel: f64,
        /// The precision that was asked for.
        precision: Precision,
    },
}

/// The mesh would have more than 2^32 - 1 vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the result has more than 4294967295 vertices; choose a larger voxel size")]
pub struct TooManyVertices;
