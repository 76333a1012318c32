//! The policy of a band: whether its nodes have signs, and which blocks need no look at each node.

use crate::candidates::CandidatePruner;
use crate::filter::Block;
use crate::lattice::Lattice;
use crate::ssvh::{Ssvh, TriangleSlot};

/// A rule for the leaves of a band. [`build_with_policy`](super::build_with_policy) builds the
/// band.
pub trait LeafPolicy: Sync {
    /// Whether nodes get the sign of their distance.
    ///
    /// Without signs, distances are not negative and `values` stay empty. Nothing is known of
    /// blocks beyond the band. Every leaf is worked off by candidate lists, and all of them are
    /// kept.
    const IS_SIGNED: bool;

    /// Decides about all nodes of a block by the triangles that can be closest to them. `None`:
    /// each node is looked at.
    fn decide(&self, block: &BlockCandidates<'_>) -> Option<BlockState>;
}

/// The state of all nodes of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockState {
    /// No node of the block matters.
    Unwanted,
    /// All nodes of the block are inside.
    Inside,
}

/// The policy of the band around an offset surface: signed values, and each node is looked at.
#[derive(Clone, Copy, Debug, Default)]
pub struct SignedBand;

impl LeafPolicy for SignedBand {
    const IS_SIGNED: bool = true;

    #[inline(always)]
    fn decide(&self, _: &BlockCandidates<'_>) -> Option<BlockState> {
        None
    }
}

/// A block of nodes with the list of all triangles that can be closest to any of them.
pub struct BlockCandidates<'a> {
    /// Holds the list, at `depth`.
    pub(super) pruner: &'a CandidatePruner,
    pub(super) depth: usize,
    pub(super) block: Block,
    /// The block's centre relative to the leaf's, in voxels.
    pub(super) centre: [f32; 3],
    pub(super) lattice: Lattice,
    pub(super) ssvh: &'a Ssvh,
    /// Bounds of the distance from the block's centre to the mesh, in model units.
    pub(super) distance: [f64; 2],
}

impl BlockCandidates<'_> {
    /// Returns the least and the largest distance that a node of the block can have, in model
    /// units.
    pub fn distances(&self) -> [f64; 2] {
        let radius = self.block.radius(self.lattice);
        [self.distance[0] - radius, self.distance[1] + radius]
    }

    /// Whether all nodes are more than `height`, in model units, over the planes of all triangles
    /// in the list.
    pub fn is_above(&self, height: f64) -> bool {
        let height = (height / self.lattice.voxel) as f32;
        self.pruner.is_above(self.depth, self.centre, self.block.width, height)
    }

    /// Whether all nodes are under the planes of all triangles in the list, and no triangle of the
    /// list is excepted.
    pub fn is_below(&self, is_excepted: impl Fn(u32) -> bool) -> bool {
        let by_slot = |slot: TriangleSlot| is_excepted(self.ssvh.id_at(slot));
        self.pruner.is_below(self.depth, self.centre, self.block.width, by_slot)
    }
}
