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

    #[inline]
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
    /// Numbers the leaves of all parts.
    index: LeafIndex,
    /// Per leaf its part, and its number there.
    places: Vec<(u32, u32)>,
    /// As they were made: they are not moved together.
    parts: Vec<BlockLists>,
}

impl CandidateLists {
    /// From parts: the lists of some leaves, and the leaves' origins in the same order.
    ///
    /// # Panics
    /// When the numbers of leaves differ.
    pub fn new(lattice: Lattice, parts: impl IntoIterator<Item = (Vec<Ijk>, BlockLists)>) -> CandidateLists {
        let (mut all, mut places, mut lists) = (Vec::new(), Vec::new(), Vec::new());
        for (part, (origins, own)) in (0..).zip(parts) {
            assert_eq!(origins.len(), own.leaves.len(), "lists for each leaf");
            places.extend((0..origins.len() as u32).map(|n| (part, n)));
            all.extend(origins);
            lists.push(own);
        }
        CandidateLists { lattice, index: LeafIndex::new(&all), places, parts: lists }
    }

    /// Positions in the hierarchy of the triangles that can be closest to a point of the cell whose lowest node is
    /// `node`, and of its edges; `None` when the surface is not that near.
    #[inline]
    pub fn of_cell(&self, node: Ijk) -> Option<&[u32]> {
        let (part, leaf) = self.places[self.index.get(node)?];
        self.parts[part as usize].list(leaf as usize, node)
    }

    /// The same for a point.
    #[inline]
    pub fn at(&self, p: [f64; 3]) -> Option<&[u32]> {
        // Beyond the lattice, casting saturates, and there is no list.
        self.of_cell(Ijk(p.map(|x| (x / self.lattice.voxel).floor() as i32)))
    }
}
