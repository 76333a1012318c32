//! The narrow band around the offset surface ([LW11] section IV): lattice, leaves, signs.

mod lattice;
mod signs;

pub use lattice::{Axis, Ijk, LEAF_DIM, LEAF_SIZE, Lattice};
pub use signs::{LeafId, LeafMask, SignField};
