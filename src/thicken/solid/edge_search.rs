//! The way along a lattice edge to where it leaves the solid, through which of its faces, and the normal there.

use super::region::{Place, Solid};
use crate::distance::Sample;
use crate::edge::Crossing;
use crate::lattice::Axis;
use glam::DVec3;

/// The part of the solid's boundary that an edge crosses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Part {
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

/// Bisection ends at this length, in voxels: far below what the placement of a vertex shows, far above rounding.
const SHORTEST: f64 = 1e-6;

/// Distances this near to the lid or the shell, in voxels, are on it: far below what the placement of a vertex shows.
const ON_FACE: f64 = 1e-5;

/// Steps along the distance before bisection alone goes on. One suffices where one triangle is the closest along the edge.
const STEPS: usize = 12;

/// How far beside the plane of a wall, in voxels, the two points are that are asked to see whether the edge leaves the solid
/// there: together less than [`SHORTEST`].
const BESIDE: f64 = 0.3 * SHORTEST;

/// A point of an edge.
#[derive(Clone, Copy)]
pub(crate) struct End {
    /// From 0 at the edge's lower node to 1.
    pub t: f64,
    pub sample: Sample,
}

/// A lattice edge.
pub(crate) struct Edge<'a> {
    pub solid: &'a Solid<'a>,
    /// Its lower node.
    pub start: DVec3,
    pub axis: Axis,
    /// Its length, in model units.
    pub voxel: f64,
}

/// The way to the crossing between an end inside and one outside.
pub(crate) struct Search<'a> {
    pub edge: Edge<'a>,
    /// The nearest place on the way so far that is inside.
    pub inside: End,
    outside: End,
    /// Where the outer end is.
    place: Place,
    step: usize,
    /// The signed distance of the face that is looked for, where it is the lid or the shell, and which of them.
    depth: Option<f64>,
    part: Part,
    found: Option<(Crossing, Part)>,
    /// What was told last.
    last: Option<End>,
}

/// What a search needs next.
pub(crate) enum Next {
    /// The closest point to this place on the edge.
    At(f64),
    Found(Crossing, Part),
}

impl<'a> Search<'a> {
    /// Between the ends of an edge.
    pub fn new(edge: Edge<'a>, inside: End, outside: End) -> Search<'a> {
        let place = edge.solid.place(edge.at(outside.t), &outside.sample);
        let (depth, part) = (None, Part::default());
        Search { edge, inside, outside, place, step: 0, depth, part, found: None, last: None }
    }

    /// Whether the ends say that this edge crosses the lid: the outer one is above it, and between them neither the distance
    /// nor the closest point jumps.
    pub fn is_at_lid(&self) -> bool {
        let Search { edge, inside, outside, place, .. } = self;
        let holds = |end: &End| {
            let Sample { triangle, feature, .. } = end.sample;
            edge.solid.boundary.holds(edge.solid.distance.mesh(), triangle, feature)
        };
        let most = edge.voxel * (1.0 + 1e-9);
        *place == Place::Above
            && (inside.sample.distance - outside.sample.distance).abs() <= most
            && inside.sample.closest.distance(outside.sample.closest) <= most
            && !holds(inside)
            && !holds(outside)
    }

    /// The place to look at next, or what was found.
    pub fn ask(&mut self) -> Next {
        if let Some((crossing, part)) = self.found {
            return Next::Found(crossing, part);
        }
        let Search { edge, inside, outside, place, step, .. } = self;
        let (solid, place, step) = (edge.solid, *place, *step);
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
    pub fn tell(&mut self, middle: End) {
        let Search { edge, inside, outside, .. } = self;
        self.step += 1;
        self.last = Some(middle);
        let place = edge.solid.place(edge.at(middle.t), &middle.sample);
        if place != Place::Inside {
            (*outside, self.place) = (middle, place);
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
    /// The point at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
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
