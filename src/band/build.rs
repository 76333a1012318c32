//! Builds the narrow band: bounding boxes in parallel, leaves out in a fixed order.

use super::LeafBatch;
use super::leaf::Leaf;
use super::policy::{LeafPolicy, SignedBand};
use crate::candidates::CandidatePruner;
use crate::distance::SignedDistance;
use crate::filter::{Block, BoxSide, Filter, FilterSettings, FilterStatistics, Switch, Verdict};
use crate::geom::aabb::Aabb;
use crate::lattice::{Ijk, LEAF_DIM, Lattice, Slab};
use crate::run::{Cancelled, Phase, RunSettings};
use crate::ssvh::Hit;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// The band to build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandSettings {
    /// The lattice.
    pub lattice: Lattice,
    /// The offset distance r in model units.
    pub r: f64,
    /// Half-width in voxels: nodes with abs(phi) < half_width h become active. At least 1.
    pub half_width: f64,
    /// The part of the lattice to work off.
    pub slab: Slab,
}

impl BandSettings {
    /// Returns the value of nodes outside the band, as stored.
    pub fn background(&self) -> f32 {
        self.lattice.background(self.half_width)
    }
}

/// Returns the nodes of the grid: from the first to the second, inclusive. They enclose the model
/// and, when growing, its offset surface, with the band.
pub fn grid_nodes(bounds: Aabb, settings: &BandSettings) -> [Ijk; 2] {
    let bounds = bounds.grown(settings.r.max(0.0) + settings.half_width * settings.lattice.voxel);
    let index = |x: f64| (x / settings.lattice.voxel) as i32;
    [Ijk(bounds.lo.to_array().map(|x| index(x) - 1)), Ijk(bounds.hi.to_array().map(|x| index(x) + 1))]
}

/// Bounding boxes along the grid's longest side. More: queries at their centres are wasted. Fewer:
/// the octree starts higher and there are fewer tasks to share out among the threads.
const BOXES_ALONG_AXIS: i32 = 8;

/// Distance from the offset surface, in voxels, below which a node is on it, and so outside. A face
/// of the offset often lies in a plane of nodes (with a resolution instead of a voxel size, a model
/// centred at the origin always has one there). Rounding would give these nodes signs at random,
/// and the surface would zigzag between two layers of cells. Far below the tolerance of edge
/// intersections.
const ON_SURFACE: f64 = 1e-9;

/// Bounding boxes worked off together at most, for a band whose leaves are handed on as they are:
/// those of two such batches are in memory at a time.
pub const BOXES_PER_BATCH: usize = 64;

/// Builds the band around the offset surface and hands it, batch by batch in a fixed order, to
/// `sink`.
///
/// # Errors
/// Cancellation, or what `sink` returns.
pub fn build<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    run: &RunSettings,
    sink: impl FnMut(LeafBatch) -> Result<(), E> + Send,
) -> Result<FilterStatistics, E> {
    build_map(distance, settings, BOXES_PER_BATCH, run, LeafBatch::clone, sink)
}

/// Builds the band as [`build`] does, but maps each batch with `map` on the worker thread before it
/// reaches `sink`, so that the batch's memory is used again. At most `boxes_in_flight` boxes are
/// worked off before all threads wait for each other.
///
/// # Errors
/// Cancellation, or what `sink` returns.
pub fn build_map<T: Send, E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    boxes_in_flight: usize,
    run: &RunSettings,
    map: impl Fn(&LeafBatch) -> T + Sync,
    sink: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<FilterStatistics, E> {
    let plan = Plan::new(distance, settings, &FilterSettings::default());
    build_with(plan, settings, SignedBand, boxes_in_flight, run, map, sink)
}

/// Builds the band as [`build`] does, with some filters off or other bounding boxes. For closed
/// input the leaves and their values do not change; only the blocks between the leaves are divided
/// differently.
///
/// # Errors
/// Cancellation, or what `sink` returns.
///
/// # Panics
/// When `filters` are not valid.
pub fn build_filtered<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    filters: &FilterSettings,
    run: &RunSettings,
    sink: impl FnMut(LeafBatch) -> Result<(), E> + Send,
) -> Result<FilterStatistics, E> {
    let plan = Plan::new(distance, settings, filters);
    build_with(plan, settings, SignedBand, BOXES_PER_BATCH, run, LeafBatch::clone, sink)
}

fn build_with<T: Send, E: From<Cancelled> + Send>(
    plan: Plan<'_>,
    settings: &BandSettings,
    policy: impl LeafPolicy,
    boxes_in_flight: usize,
    run: &RunSettings,
    map: impl Fn(&LeafBatch) -> T + Sync,
    mut sink: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<FilterStatistics, E> {
    let Plan { filter, boxes, mut statistics } = plan;
    let worker = Worker { filter, settings: *settings, policy };
    let scratch = Mutex::new(Vec::new());
    let phase = run.phase(Phase::Band, boxes.len() as u64);
    run.install(|| {
        let mut ready: Vec<T> = Vec::new();
        let mut batches = boxes.chunks(boxes_in_flight);
        loop {
            let next = batches.next();
            // The bridge takes the last batch while the workers fill the next one.
            let (sunk, filled) = rayon::join(
                || ready.into_iter().try_for_each(&mut sink),
                || next.map(|boxes| worker.fill(boxes, &scratch, &map, &phase)),
            );
            sunk?;
            let Some(filled) = filled else { break };
            let (batches, counts) = filled?;
            statistics += counts;
            ready = batches;
        }
        Ok(statistics)
    })
}

/// Builds the band by a policy of its own, all boxes in one go. For a policy without signs,
/// `settings.r` is zero: distances of an open mesh jump where there is no surface.
///
/// `inside` and `inside_blocks` of the batches hold the nodes that the policy knows to be inside.
///
/// # Errors
/// Cancellation, or what `sink` returns.
pub fn build_with_policy<E: From<Cancelled> + Send>(
    distance: &SignedDistance,
    settings: &BandSettings,
    policy: impl LeafPolicy,
    run: &RunSettings,
    sink: impl FnMut(LeafBatch) -> Result<(), E> + Send,
) -> Result<FilterStatistics, E> {
    let plan = Plan::new(distance, settings, &FilterSettings::default());
    // The caller keeps all of it.
    build_with(plan, settings, policy, usize::MAX, run, LeafBatch::clone, sink)
}

/// The work of a band: the boxes to go through, and the filters.
pub(super) struct Plan<'a> {
    pub(super) filter: Filter<'a>,
    pub(super) boxes: Vec<Block>,
    /// Statistics with the number of the grid's nodes.
    pub(super) statistics: FilterStatistics,
}

impl<'a> Plan<'a> {
    /// # Panics
    /// When `filters` are not valid.
    pub(super) fn new(
        distance: &'a SignedDistance<'a>,
        settings: &BandSettings,
        filters: &FilterSettings,
    ) -> Self {
        filters.validate().expect("valid filter settings");
        let bounds = Aabb::around(distance.mesh().vertices.iter().map(|&v| DVec3::from(v)));
        let grid = grid_nodes(bounds, settings);
        let filter = Filter {
            distance,
            lattice: settings.lattice,
            r: settings.r,
            half_width: f64::from(settings.background()),
            settings: *filters,
            slab: settings.slab,
        };
        let statistics = FilterStatistics { nodes_total: node_count(grid), ..Default::default() };
        let mut boxes = bounding_boxes(grid, filters.side);
        boxes.retain(|b| settings.slab.computes(b.origin, b.width));
        Plan { filter, boxes, statistics }
    }
}

fn node_count([lo, hi]: [Ijk; 2]) -> u64 {
    (hi - lo).0.map(|n| n as u64 + 1).iter().product()
}

/// Returns the bounding boxes that cover the grid, in lexicographic order.
fn bounding_boxes([lo, hi]: [Ijk; 2], side: BoxSide) -> Vec<Block> {
    let longest = (hi - lo).0.into_iter().max().expect("three axes") + 1;
    let width = match side {
        // The power of two at or below.
        BoxSide::Automatic => 1 << (longest / BOXES_ALONG_AXIS).max(2 * LEAF_DIM).ilog2(),
        BoxSide::PowerOfTwo(n) => 1 << n,
    };
    let first = lo.0.map(|i| i.div_euclid(width));
    let last = hi.0.map(|i| i.div_euclid(width));
    let mut boxes = Vec::new();
    for i in first[0]..=last[0] {
        for j in first[1]..=last[1] {
            for k in first[2]..=last[2] {
                boxes.push(Block { origin: Ijk::new(i * width, j * width, k * width), width });
            }
        }
    }
    boxes
}

/// Fills leaves.
pub(super) struct Worker<'a, P> {
    pub(super) filter: Filter<'a>,
    pub(super) settings: BandSettings,
    pub(super) policy: P,
}

/// The working memory of a thread, used for one box after the other.
#[derive(Default)]
struct Scratch {
    pruner: CandidatePruner,
    batch: LeafBatch,
}

impl<P: LeafPolicy> Worker<'_, P> {
    fn fill<T: Send>(
        &self,
        boxes: &[Block],
        scratch: &Mutex<Vec<Scratch>>,
        map: impl Fn(&LeafBatch) -> T + Sync,
        phase: &crate::run::PhaseGuard,
    ) -> Result<(Vec<T>, FilterStatistics), Cancelled> {
        // As many as there are threads at most, whatever became of one that held the lock.
        let pool = || scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let in_box = |&block: &Block| {
            phase.advance(1)?;
            let idle = pool().pop();
            let mut own: Scratch = idle.unwrap_or_default();
            let Scratch { pruner, batch } = &mut own;
            batch.clear();
            let counts = self.bounding_box(block, pruner, batch);
            let is_kept = !batch.is_empty() || !batch.inside_blocks.is_empty();
            let kept = is_kept.then(|| map(batch));
            pool().push(own);
            Ok((kept, counts))
        };
        let filled: Vec<(Option<T>, FilterStatistics)> =
            boxes.par_iter().with_max_len(1).map(in_box).collect::<Result<_, Cancelled>>()?;
        let mut statistics = FilterStatistics::default();
        filled.iter().for_each(|&(_, counts)| statistics += counts);
        Ok((filled.into_iter().filter_map(|(kept, _)| kept).collect(), statistics))
    }

    /// Appends the leaves of a box to `batch`.
    fn bounding_box(
        &self,
        block: Block,
        pruner: &mut CandidatePruner,
        batch: &mut LeafBatch,
    ) -> FilterStatistics {
        let mut statistics = FilterStatistics::default();
        let mut kept: Vec<(Ijk, u32, f64)> = Vec::new();
        match self.filter.bounding_box(block, &mut statistics) {
            Verdict::Outside => {}
            Verdict::Inside => self.push_inside(block, batch),
            Verdict::Kept { triangle, .. } if self.filter.settings.octree == Switch::Off => {
                for origin in block.leaves().filter(|&o| self.settings.slab.computes(o, LEAF_DIM)) {
                    let mut of_leaf = FilterStatistics::default();
                    self.whole_leaf(origin, triangle, batch, &mut of_leaf);
                    if self.settings.slab.owns(origin) {
                        statistics += of_leaf;
                    }
                }
            }
            // A box of a single leaf has no smaller ones above the leaf's own.
            Verdict::Kept { triangle, distance } if block.width == LEAF_DIM => {
                kept.push((block.origin, triangle, distance));
            }
            Verdict::Kept { triangle, .. } => {
                self.filter.octree(block, triangle, LEAF_DIM, &mut statistics, &mut |block, verdict| {
                    match verdict {
                        Verdict::Outside => {}
                        Verdict::Inside => self.push_inside(block, batch),
                        Verdict::Kept { triangle, distance } => {
                            kept.push((block.origin, triangle, distance));
                        }
                    }
                });
            }
        }
        for (origin, triangle, distance) in kept {
            let mut of_leaf = FilterStatistics::default();
            if self.filter.settings.candidates == Switch::On {
                self.leaf_from_candidates(origin, triangle, distance, pruner, batch, &mut of_leaf);
            } else {
                self.leaf_from_hierarchy(origin, triangle, batch, &mut of_leaf);
            }
            if self.settings.slab.owns(origin) {
                statistics += of_leaf;
            }
        }
        statistics
    }

    /// Adds a block on the negative side, beyond the band. Without signs, that says nothing.
    fn push_inside(&self, block: Block, batch: &mut LeafBatch) {
        if P::IS_SIGNED {
            batch.inside_blocks.push((block.origin, block.width));
        }
    }

    /// Returns the sign of the distance in all of a block whose centre has the signed distance
    /// `centre`, where that is farther from the surface than any node is from the centre.
    pub(super) fn side_around(&self, block: Block, centre: f64) -> Option<f64> {
        let is_far = centre.abs() > block.radius(self.filter.lattice) * (1.0 + 1e-9);
        is_far.then_some(1f64.copysign(centre))
    }

    /// Sets eight nodes by their closest triangles, and returns how many of them are valid. `side`
    /// is the sign of their distances, where that is known.
    pub(super) fn set_nodes(
        &self,
        nodes: &[Ijk; 8],
        points: &[DVec3; 8],
        hits: &[Hit; 8],
        side: Option<f64>,
        leaf: &mut Leaf,
        statistics: &mut FilterStatistics,
    ) -> u64 {
        let Filter { distance, lattice, r, .. } = self.filter;
        let background = self.settings.background();
        let mut valid = 0;
        for ((node, &p), hit) in nodes.iter().zip(points).zip(hits) {
            let signed = match side {
                Some(side) => side * hit.distance_squared.sqrt(),
                None => distance.from_triangle(p, hit.triangle).distance,
            };
            let phi = self.snapped_to_surface(signed - r, p);
            valid += u64::from(phi.abs() <= lattice.voxel);
            leaf.set(node.number_in_leaf(), phi, hit.triangle, background);
        }
        statistics.node_queries += 8;
        statistics.valid_nodes += valid;
        valid
    }

    /// Returns `phi` at `p`, or 0 where `phi` is so close to 0 that only rounding gives it a sign.
    fn snapped_to_surface(&self, phi: f64, p: DVec3) -> f64 {
        let rounding = 4.0 * f64::EPSILON * (p.abs().max_element() + self.settings.r.abs());
        if phi.abs() <= ON_SURFACE * self.settings.lattice.voxel + rounding { 0.0 } else { phi }
    }
}
