//! The lattice of grid nodes and its index types.
//!
//! Node (i, j, k) lies at world position h (i, j, k): the lattice is anchored at the world origin,
//! so that the grids of different models with the same voxel size line up.
//!
//! Leaves are blocks of 8 x 8 x 8 nodes, the size of OpenVDB's leaf nodes, and a node's number
//! within its leaf has z fastest, as there:
//!
//! ```text
//!  number = 64 x + 8 y + z      word x of a 512-bit mask, bit 8 y + z of that word
//! ```

mod axis;
mod error;
mod ijk;
mod world;
mod facing_layer;
pub(crate) mod leaf_index;
mod leaf_mask;
mod slab;

pub use axis::Axis;
pub use error::LatticeError;
pub use facing_layer::facing_layer;
pub use ijk::{Ijk, LEAF_DIM, LEAF_SIZE};
pub use leaf_index::LeafIndex;
pub use leaf_mask::{LeafMask, Z_FIRST, Z_LAST, bits};
pub use slab::Slab;
pub use world::Lattice;
