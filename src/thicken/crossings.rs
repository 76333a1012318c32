//! Where lattice edges leave the solid, through which of its faces, and the normal there.

use super::near_nodes::near_nodes;
use super::solid::{Place, Solid};
use crate::band::{LeafId, LeafMask, SignField};
use crate::candidates::{Candidates, block_in_leaf};
use crate::distance::Sample;
use crate::edge::{Crossing, Crossings, EdgeNumbers, NodeTriangles, bits};
use crate::error::Error;
use crate::lattice::{Axis, Ijk, Lattice};
use crate::run::{Cancelled, Phase, RunSettings};
use glam::DVec3;
use rayon::prelude::*;

/// The part of the solid's boundary that an edge crosses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Part {
    /// The lid, below S: left out of the result.
    Lid,
    /// The inner shell, at distance r.
    #[default]
    Shell,
    /// The cross-section, over the boundary of S.
    Section,
    /// The middle between a sheet's inner side and another one's outer side.
    Middle,
}

/// Crossings, with the part of each.
#[derive(Debug)]
pub(super) struct SolidCrossings {
    pub crossings: Crossings,
    /// By edge number.
    pub parts: Vec<Part>,
    /// Where the edges cross, by edge number.
    pub points: Vec<DVec3>,
}

/// Bisection ends at this length, in voxels: far below what the placement of a vertex shows, far above rounding.
const SHORTEST: f64 = 1e-6;

/// Distances this near to the lid or the shell, in voxels, are on it: far below what the placement of a vertex shows.
const ON_FACE: f64 = 1e-5;

/// Steps along the distance before bisection alone goes on. One suffices where one triangle is the closest along the edge.
const STEPS: usize = 12;

/// How far beside the plane of a wall, in voxels, the two points are that are asked to see whether the edge leaves the solid
/// there: together less than [`SHORTEST`].
const BESIDE: f64 = 0.3 * SHORTEST;

/// Edges that are followed together.
const TOGETHER: usize = 8;

/// Finds the crossings of edges that change sign: all but those of the lid that are more than some voxels from anything else,
/// since nothing of the lid gets into the result.
pub(super) fn crossings(
    solid: &Solid<'_>,
    lattice: Lattice,
    signs: &SignField,
    nodes: &NodeTriangles,
    run: &RunSettings,
) -> Result<SolidCrossings, Error> {
    let leaves: Vec<LeafId> = signs.leaves().collect();
    let of_leaf = |&leaf: &LeafId| LeafNodes { solid, lattice, signs, nodes, leaf };
    let numbers = run.install(|| {
        let other = leaves.par_iter().with_min_len(16).map(|leaf| of_leaf(leaf).beyond_lid()).collect();
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
        leaves.par_iter().with_min_len(4).map(in_leaf).collect::<Result<_, Cancelled>>()
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

/// A point of an edge.
#[derive(Clone, Copy)]
struct End {
    /// From 0 at the edge's lower node to 1.
    t: f64,
    sample: Sample,
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
            let hits = near.map(|near| near.closest_to_eight(distance.ssvh(), &points, count, expected));
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
        Search { edge, inside, outside, step: 0, depth: None, part: Part::default(), found: None, last: None }
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

/// A lattice edge.
struct Edge<'a> {
    solid: &'a Solid<'a>,
    start: DVec3,
    axis: Axis,
    voxel: f64,
}

/// The way to the crossing between an end inside and one outside.
struct Search<'a> {
    edge: Edge<'a>,
    inside: End,
    outside: End,
    step: usize,
    /// The signed distance of the face that is looked for, where it is the lid or the shell, and which of them.
    depth: Option<f64>,
    part: Part,
    found: Option<(Crossing, Part)>,
    /// What was told last.
    last: Option<End>,
}

/// What a search needs next.
enum Next {
    /// The closest point to this place on the edge.
    At(f64),
    Found(Crossing, Part),
}

impl Search<'_> {
    /// Whether the ends say that this edge crosses the lid: the outer one is above it, and between them neither the distance
    /// nor the closest point jumps.
    fn is_at_lid(&self) -> bool {
        let Search { edge, inside, outside, .. } = self;
        let place = edge.solid.place(edge.at(outside.t), &outside.sample);
        let holds = |end: &End| {
            let Sample { triangle, feature, .. } = end.sample;
            edge.solid.boundary.holds(edge.solid.distance.mesh(), triangle, feature)
        };
        let most = edge.voxel * (1.0 + 1e-9);
        place == Place::Above
            && (inside.sample.distance - outside.sample.distance).abs() <= most
            && inside.sample.closest.distance(outside.sample.closest) <= most
            && !holds(inside)
            && !holds(outside)
    }

    /// The place to look at next, or what was found.
    fn ask(&mut self) -> Next {
        if let Some((crossing, part)) = self.found {
            return Next::Found(crossing, part);
        }
        let Search { edge, inside, outside, step, .. } = self;
        let (solid, step) = (edge.solid, *step);
        let place = solid.place(edge.at(outside.t), &outside.sample);
        self.part = if place == Place::Above { Part::Lid } else { Part::Shell };
        self.depth = match place {
            Place::Above => Some(-solid.lid),
            Place::Below => Some(-solid.thickness_at(&outside.sample)),
            Place::Beside | Place::Inside => None,
        };
        if let Some(depth) = self.depth
            && (outside.sample.distance - depth).abs() <= ON_FACE * edge.voxel
        {
            return Next::Found(edge.on_face(*outside, self.part), self.part);
        }
        let width = outside.t - inside.t;
        if width.abs() <= SHORTEST {
            let (crossing, part) = edge.at_jump(*inside, *outside);
            return Next::Found(crossing, part);
        }
        let share = match self.depth {
            // Some steps halve, so that a jump of the distance does not take for ever.
            Some(depth) if step < STEPS && step % 4 != 3 => {
                let (a, b) = (inside.sample.distance - depth, outside.sample.distance - depth);
                // A little beyond the root, so that it is the outside end that gets near.
                let secant = (a / (a - b) + 1e-9).clamp(0.0, 1.0);
                let newton = self.last.and_then(|last| edge.tangent(&last, depth));
                let share = newton.map(|t| (t - inside.t) / width);
                share.filter(|&share| share > 0.0 && share < 1.0).unwrap_or(secant)
            }
            None if place == Place::Beside && step < STEPS => {
                edge.at_wall(inside, outside, step % 2 == 0).unwrap_or(0.5)
            }
            _ => 0.5,
        };
        Next::At(inside.t + share * width)
    }

    /// Takes what was asked for.
    fn tell(&mut self, middle: End) {
        let Search { edge, inside, outside, .. } = self;
        self.step += 1;
        self.last = Some(middle);
        if edge.solid.place(edge.at(middle.t), &middle.sample) != Place::Inside {
            *outside = middle;
            return;
        }
        // As good as on the face, from the inside.
        if let Some(depth) = self.depth
            && (middle.sample.distance - depth).abs() <= ON_FACE * edge.voxel
        {
            self.found = Some((edge.on_face(middle, self.part), self.part));
        }
        *inside = middle;
    }
}

impl Edge<'_> {
    fn at(&self, t: f64) -> DVec3 {
        let mut p = self.start;
        p[self.axis as usize] += t * self.voxel;
        p
    }

    /// Where the distance would be `depth` if it went on as it does at `end`.
    fn tangent(&self, end: &End, depth: f64) -> Option<f64> {
        let Sample { distance, closest, .. } = end.sample;
        let slope = (self.at(end.t) - closest)[self.axis as usize] / distance;
        let t = end.t + (depth - distance) / (slope * self.voxel);
        t.is_finite().then_some(t)
    }

    /// The part of the way from the inner end to the outer one at which to look for the wall that the outer one is beyond: a
    /// little beyond the wall's plane, then a little before it. `None` where that leads nowhere, or only the second was
    /// wanted and the first has not been looked at.
    fn at_wall(&self, inside: &End, outside: &End, is_first: bool) -> Option<f64> {
        let wall = self.solid.boundary.wall(self.solid.distance.mesh(), &outside.sample);
        let across = (self.at(outside.t) - outside.sample.closest).dot(wall) / self.voxel;
        let crossed = outside.t - across / wall[self.axis as usize];
        let width = outside.t - inside.t;
        let is_next = (outside.t - crossed).abs() < 2.0 * BESIDE;
        if !is_first && !is_next {
            return None;
        }
        let share = (crossed - inside.t + width.signum() * if is_next { -BESIDE } else { BESIDE }) / width;
        (share > 0.0 && share < 1.0).then_some(share)
    }

    fn crossing(&self, end: &End, normal: DVec3) -> Crossing {
        Crossing { t: end.t, normal: normal.as_vec3().to_array(), triangle: end.sample.triangle }
    }

    fn on_face(&self, end: End, part: Part) -> Crossing {
        let gradient = self.gradient(&end);
        self.crossing(&end, if part == Part::Lid { gradient } else { -gradient })
    }

    fn gradient(&self, end: &End) -> DVec3 {
        self.solid.distance.gradient(self.at(end.t), &end.sample, SHORTEST * self.voxel)
    }

    /// Where the closest point jumps from one part of S to another.
    fn at_jump(&self, inside: End, outside: End) -> (Crossing, Part) {
        let distance = self.solid.distance;
        if let Some((depth, normal)) = self.solid.rods.at(self.at(outside.t))
            && (depth - self.solid.lid).abs() <= self.voxel * 1e-3
        {
            return (self.crossing(&outside, normal), Part::Lid);
        }
        if self.solid.place(self.at(outside.t), &outside.sample) == Place::Beside {
            let wall = self.solid.boundary.wall(distance.mesh(), &outside.sample);
            // Where the boundary of another part of S is as near, the middle between both is the wall.
            let apart = (inside.sample.closest - outside.sample.closest).length();
            if wall != DVec3::ZERO && apart <= 0.1 * self.voxel {
                return (self.crossing(&outside, wall), Part::Section);
            }
            return (self.crossing(&outside, self.between(&inside, &outside)), Part::Section);
        }
        (self.crossing(&outside, self.between(&inside, &outside)), Part::Middle)
    }

    /// The normal of the plane between the closest points of both ends.
    fn between(&self, inside: &End, outside: &End) -> DVec3 {
        let away = |end: &End| (self.at(end.t) - end.sample.closest).normalize_or_zero();
        let mut axis = DVec3::ZERO;
        axis[self.axis as usize] = (outside.t - inside.t).signum();
        (away(inside) - away(outside)).try_normalize().unwrap_or(axis)
    }
}
