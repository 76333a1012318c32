//! Where lattice edges leave the solid: which of them matter, followed side by side as far as they have a list in common.

use super::dilate::near_nodes;
use super::edge_search::{Edge, End, Next, Part, Search};
use super::region::Solid;
use crate::band::{LeafId, NodeTriangles, SignField};
use crate::candidates::{Candidates, block_in_leaf};
use crate::distance::Sample;
use crate::edge::{Crossing, Crossings, EdgeNumbers};
use crate::error::Error;
use crate::lattice::{Axis, Ijk, Lattice, LeafMask, bits};
use crate::run::{Cancelled, Phase, RunSettings, SHARE};
use glam::DVec3;
use rayon::prelude::*;

/// Crossings, with the part of each.
#[derive(Debug)]
pub(crate) struct SolidCrossings {
    pub crossings: Crossings,
    /// By edge number.
    pub parts: Vec<Part>,
    /// Where the edges cross, by edge number.
    pub points: Vec<DVec3>,
}

/// Edges that are followed together.
const TOGETHER: usize = 8;

/// Finds the crossings of edges that change sign: all but those of the lid that are more than some voxels from anything else,
/// since nothing of the lid gets into the result.
pub(crate) fn crossings(
    solid: &Solid<'_>,
    lattice: Lattice,
    signs: &SignField,
    nodes: &NodeTriangles,
    run: &RunSettings,
) -> Result<SolidCrossings, Error> {
    let leaves: Vec<LeafId> = signs.leaves().collect();
    let of_leaf = |&leaf: &LeafId| LeafNodes { solid, lattice, signs, nodes, leaf };
    let numbers = run.install(|| {
        let other = leaves
            .par_iter()
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|leaf| of_leaf(leaf).beyond_lid())
            .collect();
        let near = near_nodes(signs, other);
        let masks = leaves.par_iter().zip(near).with_min_len(64).map(|(&leaf, near)| {
            Axis::ALL.map(|axis| {
                let crossed = signs.crossed_edges(leaf, axis);
                std::array::from_fn(|x| crossed[x] & near[x])
            })
        });
        EdgeNumbers::of_some(masks.collect())
    })?;
    let leaves: Vec<LeafId> = leaves.into_iter().filter(|&leaf| !numbers.range(leaf).is_empty()).collect();
    let phase = run.phase(Phase::Edges, leaves.len() as u64);
    let found: Vec<Vec<(Crossing, Part, DVec3)>> = run.install(|| {
        let in_leaf = |leaf: &LeafId| {
            phase.advance(1)?;
            Ok(of_leaf(leaf).cross_all(&numbers))
        };
        leaves.par_iter().with_max_len(SHARE).map(in_leaf).collect::<Result<_, Cancelled>>()
    })?;
    let count = numbers.len();
    let (mut samples, mut parts) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut points = Vec::with_capacity(count);
    for (sample, part, point) in found.into_iter().flatten() {
        samples.push(sample);
        parts.push(part);
        points.push(point);
    }
    Ok(SolidCrossings { crossings: Crossings { numbers, samples }, parts, points })
}

struct LeafNodes<'a> {
    solid: &'a Solid<'a>,
    lattice: Lattice,
    signs: &'a SignField,
    nodes: &'a NodeTriangles,
    leaf: LeafId,
}

impl<'a> LeafNodes<'a> {
    /// The lower nodes of the edges that change sign elsewhere than at the lid, as far as the ends say so.
    fn beyond_lid(&self) -> LeafMask {
        let mut other = [0; 8];
        for axis in Axis::ALL {
            for number in bits(&self.signs.crossed_edges(self.leaf, axis)) {
                other[number >> 6] |= u64::from(!self.search(axis, number).is_at_lid()) << (number & 63);
            }
        }
        other
    }

    /// The crossings of all edges that start in the leaf and have a number, in the order of the numbers.
    fn cross_all(&self, numbers: &EdgeNumbers) -> Vec<(Crossing, Part, DVec3)> {
        let unknown = (Crossing { t: 0.0, normal: [0.0; 3], triangle: 0 }, Part::default(), DVec3::ZERO);
        let mut all = vec![unknown; numbers.range(self.leaf).len()];
        let origin = self.signs.origin(self.leaf);
        // By block of 2^3 nodes, which have the same list.
        let mut order: Vec<(u32, usize, Axis, usize)> = (0..)
            .zip(numbers.in_leaf(self.leaf))
            .map(|(n, (axis, number))| (block_in_leaf(Ijk::in_leaf(origin, number)), n, axis, number))
            .collect();
        order.sort_unstable_by_key(|&(block, n, ..)| (block, n));
        for block in order.chunk_by(|a, b| a.0 == b.0) {
            let lists = self.solid.lists;
            let near = lists.and_then(|lists| lists.of_cell(Ijk::in_leaf(origin, block[0].3)));
            for edges in block.chunks(TOGETHER) {
                let mut searches: Vec<(usize, Search<'a>)> =
                    edges.iter().map(|&(_, n, axis, number)| (n, self.search(axis, number))).collect();
                self.follow(&mut searches, near.as_ref(), |n, found| all[n] = found);
            }
        }
        all
    }

    /// Follows edges until all have been found.
    fn follow(
        &self,
        searches: &mut Vec<(usize, Search<'a>)>,
        near: Option<&Candidates<'_>>,
        mut found: impl FnMut(usize, (Crossing, Part, DVec3)),
    ) {
        let distance = self.solid.distance;
        let mut asked = [(0.0, DVec3::ZERO); TOGETHER];
        while !searches.is_empty() {
            let mut count = 0;
            // None is farther from S than from what is closest to its ends.
            let mut most: f64 = 0.0;
            searches.retain_mut(|(n, search)| match search.ask() {
                Next::Found(crossing, part) => {
                    found(*n, (crossing, part, search.edge.at(crossing.t)));
                    false
                }
                Next::At(t) => {
                    let p = search.edge.at(t);
                    most = most.max(p.distance_squared(search.inside.sample.closest));
                    asked[count] = (t, p);
                    count += 1;
                    true
                }
            });
            if count == 0 {
                break;
            }
            let mut points = [asked[0].1; TOGETHER];
            for (point, (_, p)) in points.iter_mut().zip(&asked[..count]) {
                *point = *p;
            }
            // But for rounding.
            let expected = most.sqrt() * (1.0 + 1e-12);
            let hits = near.map(|near| near.closest8(distance.ssvh(), &points, count, expected));
            for (k, (_, search)) in searches.iter_mut().enumerate() {
                let (t, p) = asked[k];
                let sample = match &hits {
                    Some(hits) => distance.from_triangle(p, hits[k].triangle),
                    None => distance.at(p, search.inside.sample.triangle),
                };
                search.tell(End { t, sample });
            }
        }
    }

    fn search(&self, axis: Axis, number: usize) -> Search<'a> {
        let origin = self.signs.origin(self.leaf);
        let local = Ijk::in_leaf(Ijk::default(), number);
        let start = DVec3::from(self.lattice.world_from_index(origin + local));
        let edge = Edge { solid: self.solid, start, axis, voxel: self.lattice.voxel };
        let low = End { t: 0.0, sample: self.node(local, edge.at(0.0)) };
        let high = End { t: 1.0, sample: self.node(local.next(axis), edge.at(1.0)) };
        let low_is_inside = self.signs.inside(self.leaf)[number >> 6] >> (number & 63) & 1 == 1;
        let (inside, outside) = if low_is_inside { (low, high) } else { (high, low) };
        Search::new(edge, inside, outside)
    }

    fn node(&self, local: Ijk, p: DVec3) -> Sample {
        let known = self
            .signs
            .locate(self.leaf, local.0)
            .and_then(|(leaf, number)| self.nodes.of_leaf(leaf)?.get(number));
        match known {
            Some(triangle) => self.solid.distance.from_triangle(p, triangle),
            None => self.solid.sample(p, 0),
        }
    }
}
