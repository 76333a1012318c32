//! The octree filter (\[LW11\] section IV.D), and the order in which the filters are applied.

use super::{Block, FilterSettings, FilterStatistics, Switch, bounding_box, signed_distance};
use crate::distance::SignedDistance;
use crate::lattice::{Lattice, Slab};

/// Rounding allowance of a test, in voxels. Nodes are evaluated with an error far below this; a
/// larger value only keeps more blocks in vain.
const ROUNDING: f64 = 1e-6;

/// Width, in nodes, of the largest blocks whose centres are queried eight at a time. Centres of
/// larger blocks are so far apart that each of the eight has triangles of its own, and one descent
/// would look at all for all.
const MAX_WIDTH_TOGETHER: i32 = 4;

/// The verdict of a filter on a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// All nodes are outside the offset solid and none is in the band.
    Outside,
    /// All nodes are inside the offset solid and none is in the band.
    Inside,
    /// Nodes may be in the band.
    Kept {
        /// The triangle closest to the block's centre.
        triangle: u32,
        /// The signed distance at the block's centre.
        distance: f64,
    },
}

/// The filters for one offset distance on one lattice.
#[derive(Debug)]
pub struct Filter<'a> {
    /// The distance field of the model.
    pub distance: &'a SignedDistance<'a>,
    /// The lattice.
    pub lattice: Lattice,
    /// The offset distance r.
    pub r: f64,
    /// Half-width of the band in model units: nodes with abs(phi) up to this are kept.
    pub half_width: f64,
    /// Switches of the filters. [`bounding_box`](Self::bounding_box) heeds the first two; the
    /// caller decides whether to call [`octree`](Self::octree).
    pub settings: FilterSettings,
    /// The part of the lattice to work off. Blocks that another slab owns are not counted.
    pub slab: Slab,
}

impl Filter<'_> {
    /// Applies the bounding box filter, then the signed distance filter to a bounding box, as far
    /// as they are on.
    pub fn bounding_box(&self, block: Block, statistics: &mut FilterStatistics) -> Verdict {
        let FilterSettings { bounding_box, signed_distance, .. } = self.settings;
        let centre = block.centre(self.lattice);
        let reach = self.reach(block);
        let hit = self.distance.ssvh().closest(centre);
        let own = u64::from(self.slab.owns(block.origin));
        statistics.bounding_box_queries += own;
        let signed = self.distance.from_triangle(centre, hit.triangle).distance;
        let phi = signed - self.r;
        if bounding_box == Switch::On
            && bounding_box::rejects(hit.distance_squared.sqrt(), self.r.abs(), reach)
        {
            return uniform(phi);
        }
        if signed_distance == Switch::On && signed_distance::rejects(signed, self.r, reach) {
            statistics.signed_distance_rejected += own;
            return uniform(phi);
        }
        Verdict::Kept { triangle: hit.triangle, distance: signed }
    }

    /// Subdivides a kept block down to blocks of side `smallest` and hands to `visit` each block
    /// that is rejected on the way, and the smallest ones that are kept. Every node of `block` that
    /// is computed is in exactly one of them. `triangle` is one near the block.
    pub fn octree(
        &self,
        block: Block,
        triangle: u32,
        smallest: i32,
        statistics: &mut FilterStatistics,
        visit: &mut impl FnMut(Block, Verdict),
    ) {
        let children = block.children();
        let centres = children.map(|child| child.centre(self.lattice));
        let hits = if children[0].width <= MAX_WIDTH_TOGETHER {
            self.distance.ssvh().closest8(&centres, triangle)
        } else {
            centres.map(|centre| self.distance.ssvh().closest_from(centre, triangle))
        };
        for ((child, centre), hit) in children.into_iter().zip(centres).zip(hits) {
            if !self.slab.computes(child.origin, child.width) {
                continue;
            }
            let own = u64::from(self.slab.owns(child.origin));
            let sample = self.distance.from_triangle(centre, hit.triangle);
            let phi = sample.distance - self.r;
            if self.clearance(sample.distance) > self.reach(child) {
                statistics.octree_queries_invalid += own;
                visit(child, uniform(phi));
                continue;
            }
            statistics.octree_queries_valid += own;
            if child.width > smallest {
                self.octree(child, sample.triangle, smallest, statistics, visit);
            } else {
                visit(child, Verdict::Kept { triangle: sample.triangle, distance: sample.distance });
            }
        }
    }

    /// Returns the distance of a block's centre from the surface that the octree filter looks for,
    /// in model units. Without the signed distance filter it is the distance from the nearer one of
    /// the two surfaces at abs(r), as the counts of the paper's BB + OT have it.
    #[inline]
    pub fn clearance(&self, signed: f64) -> f64 {
        match self.settings.signed_distance {
            Switch::On => (signed - self.r).abs(),
            Switch::Off => (signed.abs() - self.r.abs()).abs(),
        }
    }

    /// Returns l + delta of Remark 1, in model units: a block whose centre has abs(phi) above that
    /// holds no valid node.
    pub fn reach(&self, block: Block) -> f64 {
        self.half_width + block.radius(self.lattice) + ROUNDING * self.lattice.voxel
    }
}

fn uniform(phi: f64) -> Verdict {
    if phi < 0.0 { Verdict::Inside } else { Verdict::Outside }
}
