//! Makes a leaf by a query of the hierarchy for every eight blocks or nodes.
//!
//! For leaves with too many candidates, and as the plain way that the lists are compared with.

use super::LeafBatch;
use super::build::Worker;
use super::leaf::{Leaf, LeafOutcome};
use super::policy::LeafPolicy;
use crate::filter::{Block, FilterStatistics, Verdict};
use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE};
use glam::DVec3;

impl<P: LeafPolicy> Worker<'_, P> {
    /// Evaluates the leaf at `origin` through the octree filter and appends it.
    pub(super) fn leaf_from_hierarchy(
        &self,
        origin: Ijk,
        triangle: u32,
        batch: &mut LeafBatch,
        statistics: &mut FilterStatistics,
    ) {
        let mut leaf = Leaf::new();
        let background = self.settings.background();
        let mut kept: [(Ijk, u32, f64); 64] = [(Ijk::default(), 0, 0.0); 64];
        let mut kept_count = 0;
        let block = Block { origin, width: LEAF_DIM };
        self.filter.octree(block, triangle, 2, statistics, &mut |block, verdict| match verdict {
            Verdict::Outside => leaf.fill(block, background),
            Verdict::Inside => leaf.fill(block, -background),
            Verdict::Kept { triangle, distance } => {
                kept[kept_count] = (block.origin, triangle, distance);
                kept_count += 1;
            }
        });
        for &(origin, triangle, distance) in &kept[..kept_count] {
            self.nodes(Block { origin, width: 2 }, triangle, distance, &mut leaf, statistics);
        }
        self.finish_without_lists(&leaf, origin, batch);
    }

    /// Evaluates every node of the leaf at `origin`, for a band without the octree filter.
    pub(super) fn whole_leaf(
        &self,
        origin: Ijk,
        triangle: u32,
        batch: &mut LeafBatch,
        statistics: &mut FilterStatistics,
    ) {
        let mut leaf = Leaf::new();
        for number in (0..LEAF_SIZE).filter(|n| n & 0b001_001_001 == 0) {
            let block = Block { origin: Ijk::in_leaf(origin, number), width: 2 };
            // A centre on the surface decides no sign.
            self.nodes(block, triangle, 0.0, &mut leaf, statistics);
        }
        self.finish_without_lists(&leaf, origin, batch);
    }

    /// Appends a leaf whose blocks have no lists.
    fn finish_without_lists(&self, leaf: &Leaf, origin: Ijk, batch: &mut LeafBatch) {
        if leaf.finish(origin, batch) == LeafOutcome::Kept {
            batch.lists.begin_leaf();
        }
    }

    /// Evaluates the eight nodes of a block of side 2 whose centre has the signed distance
    /// `centre`.
    fn nodes(
        &self,
        block: Block,
        triangle: u32,
        centre: f64,
        leaf: &mut Leaf,
        statistics: &mut FilterStatistics,
    ) {
        // Farther from the surface than any node from the centre: the sign is that of the centre.
        let side = self.side_around(block, centre);
        let nodes = block.children().map(|b| b.origin);
        let points = nodes.map(|node| DVec3::from(self.filter.lattice.world_from_index(node)));
        let hits = self.filter.distance.ssvh().closest8(&points, triangle);
        self.set_nodes(&nodes, &points, &hits, side, leaf, statistics);
    }
}
