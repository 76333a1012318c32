//! The lists of all blocks of 2^3 nodes that the offset surface may pass, by leaf.

use super::LeafIndex;
use crate::lattice::{Ijk, Lattice};

/// The number of the block of 2^3 nodes that holds a node, in 0..64 within its leaf: the halves of halves of the leaf
/// in the order of [`Block::children`](crate::filter::Block::children).
pub fn block_in_leaf(node: Ijk) -> u32 {
    let bits = |shift: i32| node.0.iter().fold(0, |n, x| 2 * n + (x >> shift & 1)) as u32;
    8 * bits(2) + bits(1)
}

/// The lists of some leaves, in any order of leaves.
#[derive(Clone, Debug, Default)]
pub struct BlockLists {
    leaves: Vec<Leaf>,
    /// Per block the end of its list.
    ends: Vec<usize>,
    /// Positions of triangles in the hierarchy.
    positions: Vec<u32>,
}

/// The blocks of a leaf that have a list.
#[derive(Clone, Copy, Debug, Default)]
struct Leaf {
    /// By number in the leaf.
    mask: u64,
    /// The number of the first one's list.
    first: usize,
}

impl BlockLists {
    /// Begins the next leaf.
    pub fn begin_leaf(&mut self) {
        self.leaves.push(Leaf { mask: 0, first: self.ends.len() });
    }

    /// Forgets the last leaf that was begun.
    ///
    /// # Panics
    /// When there is none.
    pub fn drop_leaf(&mut self) {
        let leaf = self.leaves.pop().expect("a leaf was begun");
        self.ends.truncate(leaf.first);
        self.positions.truncate(self.ends.last().copied().unwrap_or(0));
    }

    /// Adds the list of the block at `origin` to the last leaf that was begun. Blocks of a leaf come by ascending
    /// number.
    ///
    /// # Panics
    /// When no leaf was begun, or the block is not the next.
    pub fn push(&mut self, origin: Ijk, positions: &[u32]) {
        let leaf = self.leaves.last_mut().expect("a leaf was begun");
        let number = block_in_leaf(origin);
        assert!(leaf.mask >> number == 0, "blocks come by ascending number");
        leaf.mask |= 1 << number;
        self.positions.extend_from_slice(positions);
        self.ends.push(self.positions.len());
    }

    /// Appends all of `other`.
    pub fn append(&mut self, other: &mut BlockLists) {
        let (blocks, positions) = (self.ends.len(), self.positions.len());
        let leaves = other.leaves.drain(..);
        self.leaves.extend(leaves.map(|leaf| Leaf { first: leaf.first + blocks, ..leaf }));
        self.ends.extend(other.ends.drain(..).map(|end| end + positions));
        self.positions.append(&mut other.positions);
    }

    fn list(&self, leaf: usize, node: Ijk) -> Option<&[u32]> {
        let Leaf { mask, first } = *self.leaves.get(leaf)?;
        let bit = 1u64 << block_in_leaf(node);
        if mask & bit == 0 {
            return None;
        }
        let list = first + (mask & (bit - 1)).count_ones() as usize;
        let start = list.checked_sub(1).map_or(0, |before| self.ends[before]);
        Some(&self.positions[start..self.ends[list]])
    }
}

/// The lists of a whole band.
#[derive(Clone, Debug)]
pub struct CandidateLists {
    lattice: Lattice,
    index: LeafIndex,
    lists: BlockLists,
}

impl CandidateLists {
    /// From the lists of the leaves at `origins`, in that order.
    ///
    /// # Panics
    /// When the numbers of leaves differ.
    pub fn new(lattice: Lattice, origins: &[Ijk], lists: BlockLists) -> CandidateLists {
        assert_eq!(origins.len(), lists.leaves.len(), "lists for each leaf");
        CandidateLists { lattice, index: LeafIndex::new(origins), lists }
    }

    /// Positions in the hierarchy of the triangles that can be closest to a point of the cell whose lowest node is
    /// `node`, and of its edges; `None` when the surface is not that near.
    #[inline]
    pub fn of_cell(&self, node: Ijk) -> Option<&[u32]> {
        self.lists.list(self.index.get(node)?, node)
    }

    /// The same for a point.
    #[inline]
    pub fn at(&self, p: [f64; 3]) -> Option<&[u32]> {
        // Beyond the lattice, casting saturates, and there is no list.
        self.of_cell(Ijk(p.map(|x| (x / self.lattice.voxel).floor() as i32)))
    }
}
