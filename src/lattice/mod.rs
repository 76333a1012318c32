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

mod facing_layer;
pub(crate) mod leaf_index;
mod leaf_mask;
mod slab;

pub use facing_layer::facing_layer;
pub use leaf_index::LeafIndex;
pub use leaf_mask::{LeafMask, Z_FIRST, Z_LAST, bits};
pub use slab::Slab;

use std::ops::{Add, Sub};

/// Nodes along one side of a leaf.
pub const LEAF_DIM: i32 = 8;
/// Nodes in a leaf.
pub const LEAF_SIZE: usize = 512;

/// A lattice index: of a node, or of the cell whose lowest corner is that node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ijk(pub [i32; 3]);

impl Ijk {
    /// Returns the index (i, j, k).
    pub const fn new(i: i32, j: i32, k: i32) -> Self {
        Ijk([i, j, k])
    }

    /// Returns the origin of the leaf that contains this node.
    pub fn leaf_origin(self) -> Ijk {
        Ijk(self.0.map(|x| x & !(LEAF_DIM - 1)))
    }

    /// Returns the number of this node within its leaf, in 0..512.
    pub fn number_in_leaf(self) -> usize {
        let [x, y, z] = self.0.map(|x| (x & (LEAF_DIM - 1)) as usize);
        64 * x + 8 * y + z
    }

    /// Returns the node with `number` (0..512) in the leaf at `origin`.
    pub fn in_leaf(origin: Ijk, number: usize) -> Ijk {
        let n = number as i32;
        origin + Ijk::new(n >> 6, (n >> 3) & 7, n & 7)
    }

    /// Returns the next node along `axis`.
    pub fn next(mut self, axis: Axis) -> Ijk {
        self.0[axis as usize] += 1;
        self
    }
}

impl Add for Ijk {
    type Output = Ijk;
    fn add(self, o: Ijk) -> Ijk {
        Ijk([self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2]])
    }
}

impl Sub for Ijk {
    type Output = Ijk;
    fn sub(self, o: Ijk) -> Ijk {
        Ijk([self.0[0] - o.0[0], self.0[1] - o.0[1], self.0[2] - o.0[2]])
    }
}

/// One of the three lattice directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Axis {
    /// Along i.
    X = 0,
    /// Along j.
    Y = 1,
    /// Along k.
    Z = 2,
}

impl Axis {
    /// The three axes in order.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// Returns the other two axes, in the cyclic order that makes (self, first, second)
    /// right-handed.
    pub const fn others(self) -> (Axis, Axis) {
        match self {
            Axis::X => (Axis::Y, Axis::Z),
            Axis::Y => (Axis::Z, Axis::X),
            Axis::Z => (Axis::X, Axis::Y),
        }
    }
}

/// World positions of lattice nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Voxel size h in model units: the width of a cell.
    pub voxel: f64,
}

/// Factor by which a background is larger than half-width times voxel size at least: two units in
/// the last place of an f32. Then neither the voxel size rounded to f32 nor a division or product
/// rounded to it makes fewer voxels of the background: these are off by a quarter of that each.
/// Much more, and nodes farther out would be in the band.
const BACKGROUND_MARGIN: f64 = 1.0 + 2.0 * f32::EPSILON as f64;

impl Lattice {
    /// Returns the world coordinate of the node plane with index `i` along any axis.
    pub fn plane(&self, i: i32) -> f64 {
        self.voxel * f64::from(i)
    }

    /// Returns the value of nodes outside a band of `half_width` voxels, as stored: slightly above
    /// their product, in model units. Other programs count the voxels back, in 32 or 64 bits, and
    /// take what is less than three for no level set.
    pub fn background(&self, half_width: f64) -> f32 {
        let least = half_width * self.voxel * BACKGROUND_MARGIN;
        let background = least as f32;
        if f64::from(background) < least { background.next_up() } else { background }
    }

    /// Returns the world position of node `ijk`.
    pub fn world_from_index(&self, ijk: Ijk) -> [f64; 3] {
        ijk.0.map(|i| self.plane(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_within_a_leaf_are_those_of_openvdb() {
        for n in 0..LEAF_SIZE {
            let node = Ijk::in_leaf(Ijk::new(-16, 8, 0), n);
            assert_eq!(node.number_in_leaf(), n);
            assert_eq!(node.leaf_origin(), Ijk::new(-16, 8, 0));
        }
        assert_eq!(Ijk::new(-1, -8, -9).leaf_origin(), Ijk::new(-8, -8, -16));
        assert_eq!(Ijk::new(1, 2, 3).number_in_leaf(), 64 + 16 + 3);
    }
}
