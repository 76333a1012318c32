//! The lists of all blocks of 2^3 nodes that the offset surface may pass, by leaf.

use super::bounded_list::{Candidates, PlaneBound, base, packed};
use crate::filter::Block;
use crate::lattice::{Ijk, Lattice, LeafIndex};

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
    /// Per block what the bounds of its list are above.
    bases: Vec<f32>,
    /// Per candidate its slot in the hierarchy.
    slots: Vec<u32>,
    /// And its bound, packed.
    packed: Vec<u32>,
}

/// The blocks of a leaf that have a list.
#[derive(Clone, Copy, Debug, Default)]
struct Leaf {
    /// By number in the leaf.
    mask: u64,
    /// The number of the first one's list.
    first: usize,
}

/// The list of a block.
struct List<'a> {
    slots: &'a [u32],
    packed: &'a [u32],
    base: f32,
}

impl BlockLists {
    /// Whether no leaf was begun.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Takes all out; the room stays.
    pub fn clear(&mut self) {
        let BlockLists { leaves, ends, bases, slots, packed } = self;
        leaves.clear();
        ends.clear();
        bases.clear();
        slots.clear();
        packed.clear();
    }

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
        self.bases.truncate(leaf.first);
        let end = self.ends.last().copied().unwrap_or(0);
        self.slots.truncate(end);
        self.packed.truncate(end);
    }

    /// Adds the list of the block at `origin` to the last leaf that was begun: slots of triangles in the hierarchy, and
    /// bounds around the centre of the block's nodes. Blocks of a leaf come by ascending number.
    ///
    /// # Panics
    /// When no leaf was begun, or the block is not the next.
    pub fn push(&mut self, origin: Ijk, slots: impl ExactSizeIterator<Item = u32>, bounds: &[PlaneBound]) {
        let leaf = self.leaves.last_mut().expect("a leaf was begun");
        let number = block_in_leaf(origin);
        assert!(leaf.mask >> number == 0, "blocks come by ascending number");
        leaf.mask |= 1 << number;
        let base = base(bounds);
        self.slots.extend(slots);
        self.packed.extend(bounds.iter().map(|&bound| packed(bound, base)));
        assert_eq!(self.slots.len(), self.packed.len(), "a bound for each slot");
        self.bases.push(base);
        self.ends.push(self.slots.len());
    }

    /// Forgets the lists of the last leaf that was begun but those of some of its blocks, a bit for each number.
    ///
    /// # Panics
    /// When no leaf was begun.
    pub fn retain_blocks(&mut self, keep: u64) {
        let leaf = self.leaves.last_mut().expect("a leaf was begun");
        let mut block = leaf.mask;
        leaf.mask &= keep;
        let mut kept = leaf.first;
        let mut end = kept.checked_sub(1).map_or(0, |before| self.ends[before]);
        let mut start = end;
        for list in leaf.first..self.ends.len() {
            let range = std::mem::replace(&mut start, self.ends[list])..self.ends[list];
            let is_kept = keep >> block.trailing_zeros() & 1 == 1;
            block &= block - 1;
            if is_kept {
                let length = range.len();
                self.slots.copy_within(range.clone(), end);
                self.packed.copy_within(range, end);
                end += length;
                self.ends[kept] = end;
                self.bases[kept] = self.bases[list];
                kept += 1;
            }
        }
        self.ends.truncate(kept);
        self.bases.truncate(kept);
        self.slots.truncate(end);
        self.packed.truncate(end);
    }

    #[inline]
    fn list(&self, leaf: usize, node: Ijk) -> Option<List<'_>> {
        let Leaf { mask, first } = *self.leaves.get(leaf)?;
        let bit = 1u64 << block_in_leaf(node);
        if mask & bit == 0 {
            return None;
        }
        let list = first + (mask & (bit - 1)).count_ones() as usize;
        let start = list.checked_sub(1).map_or(0, |before| self.ends[before]);
        let range = start..self.ends[list];
        Some(List { slots: &self.slots[range.clone()], packed: &self.packed[range], base: self.bases[list] })
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

    /// The triangles that can be closest to a point of the cell whose lowest node is `node`; `None` when the surface is not
    /// that near.
    #[inline]
    pub fn of_cell(&self, node: Ijk) -> Option<Candidates<'_>> {
        let (part, leaf) = self.places[self.index.get(node)?];
        let List { slots, packed, base } = self.parts[part as usize].list(leaf as usize, node)?;
        let block = Block { origin: Ijk(node.0.map(|x| x & !1)), side: 2 };
        Some(Candidates {
            slots,
            packed,
            base,
            centre: block.centre(self.lattice),
            voxel: self.lattice.voxel,
        })
    }

    /// The same for a point.
    #[inline]
    pub fn at(&self, p: [f64; 3]) -> Option<Candidates<'_>> {
        // Beyond the lattice, casting saturates, and there is no list.
        self.of_cell(Ijk(p.map(|x| (x / self.lattice.voxel).floor() as i32)))
    }
}
