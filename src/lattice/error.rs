//! Lattices that are too fine.

use crate::quantity::Precision;

/// A lattice that is too fine for what is made on it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// The surface crosses more lattice edges than 32-bit numbers can count.
    #[error("the offset surface crosses more than 4294967295 grid edges; choose a larger voxel size")]
    TooManyEdges,
    /// The result has more vertices than 32-bit numbers can count.
    #[error("the result has more than 4294967295 vertices; choose a larger voxel size")]
    TooManyVertices,
    /// The coordinates of the chosen precision are too coarse for the voxel size.
    #[error(
        "coordinates of size {far} are too coarse in {precision:?} for voxels of size {voxel}; \
         choose 64-bit coordinates, larger voxels, or move the model to the origin"
    )]
    CoarseCoordinates {
        /// The largest coordinate, in model units.
        far: f64,
        /// The voxel size, in model units.
        voxel: f64,
        /// The precision that was asked for.
        precision: Precision,
    },
}
