//! Crossings of lattice edges with the solid's boundary.
//!
//! Edges that have a candidate list in common are searched side by side.

use super::dilate::dilate;
use super::edge_search::{EdgeSample, EdgeSearch, LatticeEdge, SearchStep, SolidFace};
use super::region::Solid;
use crate::band::{LeafId, NodeTriangles, SignField};
use crate::candidates::{Candidates, block_in_leaf};
use crate::distance::Sample;
use crate::edge::{Crossing, Crossings, EdgeNumbers};
use crate::lattice::{Axis, Ijk, Lattice, LeafMask, bits};
use crate::run::{Cancelled, Phase, RunSettings, SHARE};
use crate::thicken::ThickenError;
use glam::DVec3;
use rayon::prelude::*;

/// Crossings of lattice edges with the solid's boundary.
#[derive(Debug)]
pub(crate) struct SolidCrossings {
    pub crossings: Crossings,
    /// Face of the solid that each edge crosses, by edge number.
    pub faces: Vec<SolidFace>,
    /// Point in which each edge crosses, by edge number.
    pub points: Vec<DVec3>,
}

/// Number of edges that are searched side by side: as many points as a list is asked for at once.
const EDGES_AT_ONCE: usize = 8;

/// Finds the crossings of edges that change sign.
///
/// Crossings of the inset that are more than some voxels from anything else are left out, since
/// nothing of the inset gets into the result.
pub(crate) fn crossings(
    solid: &Solid<'_>,
    lattice: Lattice,
    signs: &SignField,
    nodes: &NodeTriangles,
    run: &RunSettings,
) -> Result<SolidCrossings, ThickenError> {
    let leaves: Vec<LeafId> = signs.leaves().collect();
    let of_leaf = |&leaf: &LeafId| LeafNodes { solid, lattice, signs, nodes, leaf };
    let numbers = run.install(|| {
        let other = leaves
            .par_iter()
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|leaf| of_leaf(leaf).edges_off_inset())
            .collect();
        let near = dilate(signs, other);
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
    let found: Vec<Vec<(Crossing, SolidFace, DVec3)>> = run.install(|| {
        let in_leaf = |leaf: &LeafId| {
            phase.advance(1)?;
            Ok(of_leaf(leaf).cross_all(&numbers))
        };
        leaves.par_iter().with_max_len(SHARE).map(in_leaf).collect::<Result<_, Cancelled>>()
    })?;
    let count = numbers.len();
    let (mut samples, mut faces) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let mut points = Vec::with_capacity(count);
    for (sample, face, point) in found.into_iter().flatten() {
        samples.push(sample);
        faces.push(face);
        points.push(point);
    }
    Ok(SolidCrossings { crossings: Crossings { numbers, samples }, faces, points })
}

/// A leaf of the band, with the closest triangles of its nodes.
struct LeafNodes<'a> {
    solid: &'a Solid<'a>,
    lattice: Lattice,
    signs: &'a SignField,
    nodes: &'a NodeTriangles,
    leaf: LeafId,
}

impl<'a> LeafNodes<'a> {
    /// Returns the lower nodes of the edges that change sign elsewhere than at the inset, as far as
    /// the ends of an edge say so.
    fn edges_off_inset(&self) -> LeafMask {
        let mut other = [0; 8];
        for axis in Axis::ALL {
            for number in bits(&self.signs.crossed_edges(self.leaf, axis)) {
                other[number >> 6] |= u64::from(!self.search(axis, number).is_at_inset()) << (number & 63);
            }
        }
        other
    }

    /// Finds the crossings of all edges that start in the leaf and have a number, in the order of
    /// the numbers.
    fn cross_all(&self, numbers: &EdgeNumbers) -> Vec<(Crossing, SolidFace, DVec3)> {
        let unknown = (Crossing { t: 0.0, normal: [0.0; 3], triangle: 0 }, SolidFace::default(), DVec3::ZERO);
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
            for edges in block.chunks(EDGES_AT_ONCE) {
                let mut searches: Vec<(usize, EdgeSearch<'a>)> =
                    edges.iter().map(|&(_, n, axis, number)| (n, self.search(axis, number))).collect();
                self.search_all(&mut searches, near.as_ref(), |n, found| all[n] = found);
            }
        }
        all
    }

    /// Advances the searches until all crossings are found. Calls `found` with each search's
    /// number.
    fn search_all(
        &self,
        searches: &mut Vec<(usize, EdgeSearch<'a>)>,
        near: Option<&Candidates<'_>>,
        mut found: impl FnMut(usize, (Crossing, SolidFace, DVec3)),
    ) {
        let distance = self.solid.distance;
        let mut asked = [(0.0, DVec3::ZERO); EDGES_AT_ONCE];
        while !searches.is_empty() {
            let mut count = 0;
            // No point is farther from S than from the closest point of its edge's inner end.
            let mut most: f64 = 0.0;
            searches.retain_mut(|(n, search)| match search.next_step() {
                SearchStep::Found(crossing, face) => {
                    found(*n, (crossing, face, search.edge.at(crossing.t)));
                    false
                }
                SearchStep::Evaluate(t) => {
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
            let mut points = [asked[0].1; EDGES_AT_ONCE];
            for (point, (_, p)) in points.iter_mut().zip(&asked[..count]) {
                *point = *p;
            }
            // A little more, for rounding.
            let expected = most.sqrt() * (1.0 + 1e-12);
            let hits = near.map(|near| near.closest8(distance.ssvh(), &points, count, expected));
            for (k, (_, search)) in searches.iter_mut().enumerate() {
                let (t, p) = asked[k];
                let sample = match &hits {
                    Some(hits) => distance.from_triangle(p, hits[k].triangle),
                    None => distance.at(p, search.inside.sample.triangle),
                };
                search.add_sample(EdgeSample { t, sample });
            }
        }
    }

    fn search(&self, axis: Axis, number: usize) -> EdgeSearch<'a> {
        let origin = self.signs.origin(self.leaf);
        let local = Ijk::in_leaf(Ijk::default(), number);
        let start = DVec3::from(self.lattice.world_from_index(origin + local));
        let edge = LatticeEdge { solid: self.solid, start, axis, voxel: self.lattice.voxel };
        let low = EdgeSample { t: 0.0, sample: self.node(local, edge.at(0.0)) };
        let high = EdgeSample { t: 1.0, sample: self.node(local.next(axis), edge.at(1.0)) };
        let low_is_inside = self.signs.inside(self.leaf)[number >> 6] >> (number & 63) & 1 == 1;
        let (inside, outside) = if low_is_inside { (low, high) } else { (high, low) };
        EdgeSearch::new(edge, inside, outside)
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
