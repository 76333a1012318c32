//! The candidate lists of all blocks of 2^3 nodes that the offset surface may pass, by leaf.

use super::bounded_list::{Candidates, PlaneBound, base, packed};
use crate::filter::Block;
use crate::lattice::{Ijk, Lattice, LeafIndex};
use crate::ssvh::TriangleSlot;

/// Returns the number of the block of 2^3 nodes that holds a node, in 0..64 within its leaf.
///
/// The octants of a leaf, and the octants of each, follow the order of
/// [`Block::children`](crate::filter::Block::children).
pub fn block_in_leaf(node: Ijk) -> u32 {
    let bits = |shift: i32| node.0.iter().fold(0, |n, x| 2 * n + (x >> shift & 1)) as u32;
    8 * bits(2) + bits(1)
}

/// The lists of some leaves, in any order of leaves.
#[derive(Clone, Debug, Default)]
pub struct BlockLists {
    leaves: Vec<Leaf>,
    /// End of each block's list in `slots` and `packed`.
    ends: Vec<usize>,
    /// Base of the bounds of each block's list, in voxels.
    bases: Vec<f32>,
    /// Slot of each candidate in the hierarchy.
    slots: Vec<TriangleSlot>,
    /// Packed bound of each candidate.
    packed: Vec<u32>,
}

/// The blocks of a leaf that have a list.
#[derive(Clone, Copy, Debug, Default)]
struct Leaf {
    /// A bit for each block, by its number in the leaf.
    mask: u64,
    /// Number of the first block's list.
    first: usize,
}

/// The list of a block.
struct List<'a> {
    slots: &'a [TriangleSlot],
    packed: &'a [u32],
    base: f32,
}

impl BlockLists {
    /// Whether no leaf was begun.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Removes all leaves and keeps the memory.
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

    /// Removes the last leaf that was begun.
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

    /// Adds the list of the block at `origin` to the last leaf that was begun.
    ///
    /// `slots` are slots of triangles in the hierarchy, `bounds` their bounds around the centre of
    /// the block's nodes. Blocks of a leaf come by ascending number.
    ///
    /// # Panics
    /// When no leaf was begun, or the block is not the next.
    pub fn push(
        &mut self,
        origin: Ijk,
        slots: impl ExactSizeIterator<Item = TriangleSlot>,
        bounds: &[PlaneBound],
    ) {
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

    /// Keeps the lists of some blocks of the last leaf that was begun, and removes the others.
    /// `keep` has a bit for each block's number.
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
    /// Number of each leaf, over all parts.
    index: LeafIndex,
    /// Part of each leaf, and its number there.
    leaves: Vec<(u32, u32)>,
    /// Lists as they were made. They are not moved together.
    parts: Vec<BlockLists>,
}

impl CandidateLists {
    /// Combines parts. A part holds the origins of some leaves and their lists in the same order.
    ///
    /// # Panics
    /// When the numbers of leaves differ.
    pub fn new(lattice: Lattice, parts: impl IntoIterator<Item = (Vec<Ijk>, BlockLists)>) -> CandidateLists {
        let (mut all, mut leaves, mut lists) = (Vec::new(), Vec::new(), Vec::new());
        for (part, (origins, own)) in (0..).zip(parts) {
            assert_eq!(origins.len(), own.leaves.len(), "lists for each leaf");
            leaves.extend((0..origins.len() as u32).map(|n| (part, n)));
            all.extend(origins);
            lists.push(own);
        }
        CandidateLists { lattice, index: LeafIndex::new(&all), leaves, parts: lists }
    }

    /// Returns the triangles that can be closest to a point of the cell whose lowest node is
    /// `node`. `None` when the surface is not that near.
    #[inline]
    pub fn of_cell(&self, node: Ijk) -> Option<Candidates<'_>> {
        let (part, leaf) = self.leaves[self.index.get(node)?];
        let List { slots, packed, base } = self.parts[part as usize].list(leaf as usize, node)?;
        let block = Block { origin: Ijk(node.0.map(|x| x & !1)), width: 2 };
        Some(Candidates {
            slots,
            packed,
            base,
            centre: block.centre(self.lattice),
            voxel: self.lattice.voxel,
        })
    }

    /// Returns the triangles that can be closest to `p`, in model units. `None` when the surface is
    /// not near.
    #[inline]
    pub fn at(&self, p: [f64; 3]) -> Option<Candidates<'_>> {
        // Beyond the lattice, casting saturates, and there is no list.
        self.of_cell(Ijk(p.map(|x| (x / self.lattice.voxel).floor() as i32)))
    }
}
