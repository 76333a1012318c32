//! Where lattice edges leave the solid, through which of its faces, and the normal there.

use super::solid::{Place, Solid};
use crate::band::{LeafId, SignField};
use crate::distance::Sample;
use crate::edge::{Crossing, Crossings, EdgeNumbers, NodeTriangles};
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

/// Distances this near to the lid or the shell, in voxels, are on it.
const ON_FACE: f64 = 1e-6;

/// Secant steps before bisection alone goes on. Two suffice where one triangle is the closest along the edge.
const SECANTS: usize = 6;

/// Finds the crossings of all edges that change sign.
pub(super) fn crossings(
    solid: &Solid<'_>,
    lattice: Lattice,
    signs: &SignField,
    nodes: &NodeTriangles,
    run: &RunSettings,
) -> Result<SolidCrossings, Error> {
    let numbers = run.install(|| EdgeNumbers::new(signs))?;
    let leaves: Vec<LeafId> = signs.leaves().filter(|&leaf| !numbers.range(leaf).is_empty()).collect();
    let phase = run.phase(Phase::Edges, leaves.len() as u64);
    let found: Vec<Vec<(Crossing, Part, DVec3)>> = run.install(|| {
        let in_leaf = |&leaf: &LeafId| {
            phase.advance(1)?;
            let leaf_nodes = LeafNodes { solid, lattice, signs, nodes, leaf };
            Ok(numbers.in_leaf(leaf).map(|(axis, number)| leaf_nodes.cross(axis, number)).collect())
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

impl LeafNodes<'_> {
    fn cross(&self, axis: Axis, number: usize) -> (Crossing, Part, DVec3) {
        let origin = self.signs.origin(self.leaf);
        let (local, next) = {
            let local = Ijk::in_leaf(Ijk::default(), number);
            (local, local.next(axis))
        };
        let start = DVec3::from(self.lattice.world_from_index(origin + local));
        let edge = Edge { solid: self.solid, start, axis, voxel: self.lattice.voxel };
        let low = End { t: 0.0, sample: self.node(local, edge.at(0.0)) };
        let high = End { t: 1.0, sample: self.node(next, edge.at(1.0)) };
        let low_is_inside = self.signs.inside(self.leaf)[number >> 6] >> (number & 63) & 1 == 1;
        let (crossing, part) = if low_is_inside { edge.cross(low, high) } else { edge.cross(high, low) };
        (crossing, part, edge.at(crossing.t))
    }

    fn node(&self, local: Ijk, p: DVec3) -> Sample {
        let known = self.signs.locate(self.leaf, local.0).and_then(|(leaf, number)| {
            self.nodes.of_leaf(leaf).and_then(|ids| u32::try_from(ids[number]).ok())
        });
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

impl Edge<'_> {
    fn at(&self, t: f64) -> DVec3 {
        let mut p = self.start;
        p[self.axis as usize] += t * self.voxel;
        p
    }

    fn end(&self, t: f64, hint: u32) -> End {
        End { t, sample: self.solid.sample(self.at(t), hint) }
    }

    /// The crossing between an end inside and one outside.
    fn cross(&self, mut inside: End, mut outside: End) -> (Crossing, Part) {
        let solid = self.solid;
        let near = ON_FACE * self.voxel;
        for step in 0.. {
            let place = solid.place(self.at(outside.t), &outside.sample);
            let part = if place == Place::Above { Part::Lid } else { Part::Shell };
            let depth = match place {
                Place::Above => Some(-solid.lid),
                Place::Below => Some(-solid.thickness_at(&outside.sample)),
                Place::Beside | Place::Inside => None,
            };
            if let Some(depth) = depth
                && (outside.sample.distance - depth).abs() <= near
            {
                return (self.on_face(outside, part), part);
            }
            let width = outside.t - inside.t;
            if width.abs() <= SHORTEST {
                return self.at_jump(inside, outside);
            }
            let share = match depth {
                // Every other step halves, so that a jump of the distance does not take for ever.
                Some(depth) if step < 2 * SECANTS && step % 2 == 0 => {
                    let (a, b) = (inside.sample.distance - depth, outside.sample.distance - depth);
                    // A little beyond the root, so that it is the outside end that gets near.
                    (a / (a - b) + 1e-9).clamp(0.0, 1.0)
                }
                _ => 0.5,
            };
            let middle = self.end(inside.t + share * width, inside.sample.triangle);
            if solid.place(self.at(middle.t), &middle.sample) == Place::Inside {
                // As good as on the face, from the inside.
                if let Some(depth) = depth
                    && (middle.sample.distance - depth).abs() <= near
                {
                    return (self.on_face(middle, part), part);
                }
                inside = middle;
            } else {
                outside = middle;
            }
        }
        unreachable!("halving ends")
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
