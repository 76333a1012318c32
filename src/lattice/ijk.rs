//! Indices of nodes, and leaves of nodes.

use super::Axis;
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
