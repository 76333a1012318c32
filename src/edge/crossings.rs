//! Hermite data: points where the offset surface crosses grid edges, and normals there.
//!
//! Intersected edges are numbered without a hash map: per leaf and axis a 512-bit mask of the nodes
//! whose edge (to the next node along the axis) changes sign, and the numbers follow the order
//! leaf, axis, node.

use crate::band::{LeafId, SignField};
use crate::lattice::{Axis, LatticeError, LeafMask, bits};
use crate::run::SHARE;
use bytemuck::Zeroable;
use rayon::prelude::*;

/// The number of an intersected edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeId(pub u32);

/// The numbering of the intersected edges of a [`SignField`].
#[derive(Clone, Debug, Default)]
pub struct EdgeNumbers {
    /// Number of leaves with edges before each leaf, and, last, their total number.
    leaf_ranks: Vec<u32>,
    /// The leaves with edges: a third of all.
    leaves: Vec<LeafEdges>,
    count: u32,
    is_partial: bool,
}

#[derive(Clone, Copy, Debug)]
struct LeafEdges {
    leaf: LeafId,
    masks: [LeafMask; 3],
    /// The number of the first edge of the leaf.
    first: u32,
    /// Edges of the leaf before word x of an axis.
    before: [[u16; 8]; 3],
}

/// The mask of a leaf without edges.
const NO_EDGES: &LeafMask = &[0; 8];

impl EdgeNumbers {
    /// Numbers the sign changes of `signs`.
    ///
    /// # Errors
    /// When there are more than 2^32 - 1 of them.
    pub fn new(signs: &SignField) -> Result<Self, LatticeError> {
        let ids: Vec<LeafId> = signs.leaves().collect();
        let masks = ids.into_par_iter().with_min_len(16).with_max_len(SHARE);
        let masks = masks.map(|leaf| Axis::ALL.map(|axis| signs.crossed_edges(leaf, axis)));
        Self::of_masks(masks, false)
    }

    /// Numbers some of the sign changes: of each leaf, the edges of these masks, by axis.
    ///
    /// # Errors
    /// When there are more than 2^32 - 1 of them.
    pub fn of_some(masks: Vec<[LeafMask; 3]>) -> Result<Self, LatticeError> {
        Self::of_masks(masks.into_par_iter().with_min_len(64), true)
    }

    fn of_masks(
        masks: impl IndexedParallelIterator<Item = [LeafMask; 3]>,
        is_partial: bool,
    ) -> Result<Self, LatticeError> {
        let count = masks.len();
        let of_leaf = |(leaf, masks): (usize, [LeafMask; 3])| {
            let mut before = [[0; 8]; 3];
            let mut in_leaf = 0;
            for (mask, before) in masks.iter().zip(&mut before) {
                for (word, before) in mask.iter().zip(before) {
                    *before = in_leaf;
                    in_leaf += word.count_ones() as u16;
                }
            }
            // A count for now; the prefix sums follow.
            let edges = LeafEdges { leaf: LeafId(leaf as u32), masks, first: u32::from(in_leaf), before };
            (in_leaf > 0).then_some(edges)
        };
        let mut leaves: Vec<LeafEdges> = masks.enumerate().filter_map(of_leaf).collect();
        let mut leaf_ranks = Vec::with_capacity(count + 1);
        let mut edges: u64 = 0;
        for (rank, leaf) in leaves.iter_mut().enumerate() {
            // For the leaves before that have none, too.
            leaf_ranks.resize(leaf.leaf.0 as usize + 1, rank as u32);
            let next = edges + u64::from(leaf.first);
            leaf.first = u32::try_from(edges).map_err(|_| LatticeError::TooManyEdges)?;
            edges = next;
        }
        leaf_ranks.resize(count + 1, leaves.len() as u32);
        let count = u32::try_from(edges).map_err(|_| LatticeError::TooManyEdges)?;
        Ok(EdgeNumbers { leaf_ranks, leaves, count, is_partial })
    }

    /// Whether the numbering is partial: an edge that changes sign may have no number.
    pub fn is_partial(&self) -> bool {
        self.is_partial
    }

    /// Returns the number of intersected edges.
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Whether no edge is intersected.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the leaves with edges, ascending.
    pub fn leaves(&self) -> impl ExactSizeIterator<Item = LeafId> + '_ {
        self.leaves.iter().map(|edges| edges.leaf)
    }

    /// Returns the nodes of `leaf` whose edge along `axis` is intersected.
    #[inline]
    pub fn mask(&self, leaf: LeafId, axis: Axis) -> &LeafMask {
        self.of_leaf(leaf).map_or(NO_EDGES, |edges| &edges.masks[axis as usize])
    }

    /// Returns the numbers of the edges that start in `leaf`, a contiguous range.
    #[inline]
    pub fn range(&self, leaf: LeafId) -> std::ops::Range<u32> {
        let first = |leaf: usize| {
            let edges = self.leaves.get(self.leaf_ranks[leaf] as usize);
            edges.map_or(self.count, |edges| edges.first)
        };
        first(leaf.0 as usize)..first(leaf.0 as usize + 1)
    }

    /// Returns the intersected edge from node `number` of `leaf` along `axis`, if there is one.
    #[inline]
    pub fn get(&self, leaf: LeafId, axis: Axis, number: usize) -> Option<EdgeId> {
        let edges = self.of_leaf(leaf)?;
        let (word, bit) = (number >> 6, number & 63);
        let mask = edges.masks[axis as usize][word];
        if mask >> bit & 1 == 0 {
            return None;
        }
        let below = (mask & ((1 << bit) - 1)).count_ones();
        Some(EdgeId(edges.first + u32::from(edges.before[axis as usize][word]) + below))
    }

    #[inline]
    fn of_leaf(&self, leaf: LeafId) -> Option<&LeafEdges> {
        let [rank, next] = [0, 1].map(|n| self.leaf_ranks[leaf.0 as usize + n]);
        (rank < next).then(|| &self.leaves[rank as usize])
    }

    /// Returns the intersected edges that start in `leaf`, as (axis, node number), in the order of
    /// their numbers.
    pub fn in_leaf(&self, leaf: LeafId) -> impl Iterator<Item = (Axis, usize)> + '_ {
        Axis::ALL.into_iter().flat_map(move |axis| bits(self.mask(leaf, axis)).map(move |n| (axis, n)))
    }
}

/// One crossing: a sample of Hermite data.
#[derive(Clone, Copy, Debug, PartialEq, Zeroable)]
pub struct Crossing {
    /// Position along the edge, in voxels from its lower node, in 0..=1.
    pub t: f64,
    /// Unit normal of the offset surface at the crossing, pointing out of the offset solid; zero
    /// where the sign jumps and no surface is near.
    pub normal: [f32; 3],
    /// The triangle whose offset crosses there; 0 where it is unknown.
    pub triangle: u32,
}

impl Crossing {
    /// Whether the sign of the distance jumps at the crossing, far from the surface. The sign jumps
    /// where the input is open, or intersects itself.
    #[inline]
    pub fn is_jump(&self) -> bool {
        self.normal == [0.0; 3]
    }
}

/// The crossings of all intersected edges, by [`EdgeId`].
#[derive(Clone, Debug, Default)]
pub struct Crossings {
    /// The intersected edges and their numbers.
    pub numbers: EdgeNumbers,
    /// The crossing of each number.
    pub samples: Vec<Crossing>,
}

impl Crossings {
    /// Returns the crossing of edge `edge`.
    pub fn sample(&self, edge: EdgeId) -> &Crossing {
        &self.samples[edge.0 as usize]
    }
}
