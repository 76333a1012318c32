//! Makes a leaf from candidate lists: one walk of the hierarchy for all of its nodes, unless there
//! are too many candidates.

use super::LeafBatch;
use super::build::Worker;
use super::leaf::{Leaf, LeafOutcome, blocks_with_crossed_cells};
use super::policy::{BlockCandidates, BlockState, LeafPolicy};
use crate::candidates::{BlockLists, CandidatePruner, EightPoints};
use crate::filter::{Block, FilterStatistics};
use crate::lattice::{Ijk, LEAF_DIM};
use glam::DVec3;

/// Coordinate of the centre of a leaf's nodes along each axis, in voxels from the lowest node.
const LEAF_CENTRE: f32 = 0.5 * (LEAF_DIM - 1) as f32;

/// Number of candidates beyond which a leaf asks the hierarchy for every eight nodes instead.
///
/// The hierarchy goes down to the triangles that these need in the logarithm of what lists go
/// through. Dragon +2% at 512, where the lists of all leaves have 12 million triangles, takes about
/// as long either way, a little less by lists. At 64, with as many candidates in a sixtieth of the
/// leaves, lists take 3.8 s and the hierarchy 0.1 s.
const MAX_CANDIDATES: usize = 1500;

/// The leaf in the making, with its working memory.
struct Work<'a> {
    pruner: &'a mut CandidatePruner,
    lists: &'a mut BlockLists,
    statistics: &'a mut FilterStatistics,
    leaf: Leaf,
}

impl<P: LeafPolicy> Worker<'_, P> {
    /// Evaluates the leaf at `origin` and appends it with the lists of its blocks. The leaf's
    /// centre has the signed distance `distance` and the closest triangle `triangle`.
    pub(super) fn leaf_from_candidates(
        &self,
        origin: Ijk,
        triangle: u32,
        distance: f64,
        pruner: &mut CandidatePruner,
        batch: &mut LeafBatch,
        statistics: &mut FilterStatistics,
    ) {
        let block = Block { origin, width: LEAF_DIM };
        let ssvh = self.filter.distance.ssvh();
        let q = ssvh.triangle(triangle).closest(block.centre(self.filter.lattice)).point;
        // A policy without signs decides by lists.
        let most = if P::IS_SIGNED { MAX_CANDIDATES } else { usize::MAX };
        if !pruner.collect(ssvh, self.filter.lattice, block, q, most) {
            self.leaf_from_hierarchy(origin, triangle, batch, statistics);
            return;
        }
        statistics.lists[0] += pruner.count(0) as u64;
        match self.state(0, [0.0; 3], block, [distance.abs(); 2], pruner) {
            Some(BlockState::Unwanted) => return,
            Some(BlockState::Inside) => {
                batch.inside_blocks.push((origin, LEAF_DIM));
                return;
            }
            None => {}
        }
        batch.lists.begin_leaf();
        let mut work = Work { pruner, lists: &mut batch.lists, statistics, leaf: Leaf::new() };
        // Without signs, all distances are on one side.
        let side = if P::IS_SIGNED { self.side_around(block, distance) } else { Some(1.0) };
        self.octants(0, block, side, &mut work);
        let leaf = work.leaf;
        let outcome =
            if P::IS_SIGNED { leaf.finish(origin, batch) } else { leaf.finish_unsigned(origin, batch) };
        match outcome {
            LeafOutcome::Dropped => batch.lists.drop_leaf(),
            // Without signs nobody knows which cells the surface crosses.
            LeafOutcome::Kept if !P::IS_SIGNED => {}
            LeafOutcome::Kept => {
                if let (Some(inside), Some(active)) = (batch.inside.last(), batch.active.last()) {
                    batch.lists.retain_blocks(blocks_with_crossed_cells(inside, active));
                }
            }
        }
    }

    /// Applies the octree filter to the eight octants of a block, and goes on with the octants that
    /// it keeps. The block's list has the given depth. `side` is the sign of the distance in the
    /// block, where it has one sign.
    fn octants(&self, depth: usize, block: Block, side: Option<f64>, work: &mut Work<'_>) {
        let lattice = self.filter.lattice;
        let octants = block.children();
        let middle = 0.5 * (octants[0].width - 1) as f32;
        let mut centres = [[0.0; 8]; 3];
        for (n, octant) in octants.iter().enumerate() {
            for (centre, node) in centres.iter_mut().zip(octant.origin.0) {
                centre[n] = (node & (LEAF_DIM - 1)) as f32 + middle - LEAF_CENTRE;
            }
        }
        work.pruner.measure(depth, &centres, octants[0].width);
        // Where signs differ, they are those of the exact closest triangles.
        let exact = side.is_none().then(|| {
            let points = octants.map(|octant| octant.centre(lattice));
            let ssvh = self.filter.distance.ssvh();
            let hits = ssvh.closest8_among(work.pruner.list(depth), &points);
            let signed = |n: usize| self.filter.distance.from_triangle(points[n], hits[n].triangle).distance;
            std::array::from_fn::<f64, 8, _>(signed)
        });
        for (n, octant) in octants.into_iter().enumerate() {
            let nearest = work.pruner.nearest(depth, n);
            let [distance, error] = [nearest.distance, nearest.error].map(|x| lattice.voxel * f64::from(x));
            let (signed, error) = match (&exact, side) {
                (Some(signed), _) => (signed[n], 0.0),
                (None, Some(side)) => (side * distance, error),
                (None, None) => unreachable!("one of them is known"),
            };
            let phi = signed - self.filter.r;
            if self.filter.clearance(signed) > self.filter.reach(octant) + error {
                work.statistics.octree_queries_invalid += 1;
                work.leaf.fill(octant, self.settings.background().copysign(phi as f32));
                continue;
            }
            work.statistics.octree_queries_valid += 1;
            let side = side.or_else(|| self.side_around(octant, signed));
            work.pruner.prune(depth, n);
            work.statistics.lists[depth + 1] += work.pruner.count(depth + 1) as u64;
            let range = [distance - error, distance + error];
            match self.state(depth + 1, centres.map(|c| c[n]), octant, range, work.pruner) {
                Some(BlockState::Unwanted) => continue,
                Some(BlockState::Inside) => {
                    work.leaf.fill(octant, -self.settings.background());
                    continue;
                }
                None => {}
            }
            if octant.width > 2 {
                self.octants(depth + 1, octant, side, work);
                continue;
            }
            let valid = self.nodes_by_list(n, &centres, octant, side, work);
            // An edge that the surface crosses has valid ends; other blocks need no list.
            if valid > 0 || !P::IS_SIGNED {
                let (slots, bounds) = work.pruner.bounded();
                work.lists.push(octant.origin, slots, bounds);
            }
        }
    }

    /// Asks the policy about all nodes of a block, whose list is that of `depth`. `centre` is the
    /// block's centre relative to the leaf's, in voxels; the distance there is in `distance`, in
    /// model units.
    fn state(
        &self,
        depth: usize,
        centre: [f32; 3],
        block: Block,
        distance: [f64; 2],
        pruner: &CandidatePruner,
    ) -> Option<BlockState> {
        let (lattice, ssvh) = (self.filter.lattice, self.filter.distance.ssvh());
        self.policy.decide(&BlockCandidates { pruner, depth, block, centre, lattice, ssvh, distance })
    }

    /// Evaluates the eight nodes of a block of width 2, and returns the number of valid nodes. The
    /// block was pruned to last, as octant `n` with one of `centres`.
    fn nodes_by_list(
        &self,
        n: usize,
        centres: &EightPoints,
        block: Block,
        side: Option<f64>,
        work: &mut Work<'_>,
    ) -> u64 {
        let nodes = block.children().map(|b| b.origin);
        let points = nodes.map(|node| DVec3::from(self.filter.lattice.world_from_index(node)));
        let wanted = match side {
            // Nodes out of the band need no more than the side that they are on.
            Some(side) => [-1.0, 1.0].map(|end| {
                ((side * self.filter.r + end * self.filter.half_width) / self.filter.lattice.voxel) as f32
            }),
            None => [f32::NEG_INFINITY, f32::INFINITY],
        };
        let ssvh = self.filter.distance.ssvh();
        let hits = work.pruner.closest_to_nodes(n, centres, ssvh, &points, wanted);
        self.set_nodes(&nodes, &points, &hits, side, &mut work.leaf, work.statistics)
    }
}
