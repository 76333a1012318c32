//! Lengths, sizes and numbers as users give them, with their texts.

mod length;
mod precision;
mod tile_index;

pub use length::{Length, ParseQuantityError, Tolerance, VoxelSize};
pub use precision::Precision;
pub use tile_index::TileIndex;

pub(crate) use length::MAX_LATTICE_INDEX;
