//! Root finding along a lattice edge: the point in which it leaves the solid, the face that it
//! crosses there, and the normal.

use super::region::{Region, Solid};
use crate::distance::Sample;
use crate::edge::Crossing;
use crate::lattice::Axis;
use glam::DVec3;

/// Face of the solid's boundary, before the inset is replaced by S.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum SolidFace {
    /// The inset, half a voxel below S: left out of the result.
    Inset,
    /// The shell, at distance r.
    #[default]
    Shell,
    /// The section, which stands on the boundary of S.
    Section,
    /// The medial sheet between the inner side of one sheet of S and the outer side of another.
    Medial,
}

/// Length at which bisection ends, in voxels: far below what the placement of a vertex shows, far
/// above rounding.
const MIN_WIDTH: f64 = 1e-6;

/// Maximum distance of a crossing from the inset or the shell, in voxels: far below what the
/// placement of a vertex shows.
const ON_FACE: f64 = 1e-5;

/// Number of steps along the distance before bisection alone goes on. One suffices where one
/// triangle is the closest along the edge.
const MAX_ROOT_STEPS: usize = 12;

/// Distance from the plane of a wall, in voxels, of the two points that show whether the edge
/// leaves the solid there; together less than [`MIN_WIDTH`].
const WALL_PROBE: f64 = 0.3 * MIN_WIDTH;

/// A point of a lattice edge, with its closest point of S.
#[derive(Clone, Copy)]
pub(crate) struct EdgeSample {
    /// Parameter along the edge, from 0 at the lower node to 1.
    pub t: f64,
    /// The closest point of S.
    pub sample: Sample,
}

/// A lattice edge.
pub(crate) struct LatticeEdge<'a> {
    pub solid: &'a Solid<'a>,
    /// Position of the lower node.
    pub start: DVec3,
    /// Direction of the edge.
    pub axis: Axis,
    /// Length of the edge, in model units.
    pub voxel: f64,
}

/// The search for the crossing of a lattice edge, between a point inside and one outside.
pub(crate) struct EdgeSearch<'a> {
    pub edge: LatticeEdge<'a>,
    /// The point nearest to the crossing, so far, that is inside.
    pub inside: EdgeSample,
    /// The point nearest to the crossing, so far, that is outside.
    outside: EdgeSample,
    /// Region of the outside point.
    region: Region,
    /// Number of samples so far.
    step: usize,
    /// Signed distance of the face that is looked for, in model units, where it is the inset or the
    /// shell.
    depth: Option<f64>,
    /// The face that is looked for.
    face: SolidFace,
    found: Option<(Crossing, SolidFace)>,
    /// The last sample.
    last: Option<EdgeSample>,
}

/// The next step of a search.
pub(crate) enum SearchStep {
    /// The closest point of S is needed at this parameter of the edge.
    Evaluate(f64),
    /// The crossing is found, on this face.
    Found(Crossing, SolidFace),
}

impl<'a> EdgeSearch<'a> {
    /// Starts a search between the ends of an edge.
    pub fn new(edge: LatticeEdge<'a>, inside: EdgeSample, outside: EdgeSample) -> EdgeSearch<'a> {
        let region = edge.solid.classify(edge.at(outside.t), &outside.sample);
        let (depth, face) = (None, SolidFace::default());
        EdgeSearch { edge, inside, outside, region, step: 0, depth, face, found: None, last: None }
    }

    /// Whether the ends say that this edge crosses the inset: the outer end is above it, and
    /// between the ends neither the distance nor the closest point jumps.
    pub fn is_at_inset(&self) -> bool {
        let EdgeSearch { edge, inside, outside, region, .. } = self;
        let is_on_boundary = |end: &EdgeSample| {
            let Sample { triangle, feature, .. } = end.sample;
            edge.solid.boundary.holds(edge.solid.distance.mesh(), triangle, feature)
        };
        let most = edge.voxel * (1.0 + 1e-9);
        *region == Region::Above
            && (inside.sample.distance - outside.sample.distance).abs() <= most
            && inside.sample.closest.distance(outside.sample.closest) <= most
            && !is_on_boundary(inside)
            && !is_on_boundary(outside)
    }

    /// Returns the parameter at which the search needs a sample, or the crossing.
    pub fn next_step(&mut self) -> SearchStep {
        if let Some((crossing, face)) = self.found {
            return SearchStep::Found(crossing, face);
        }
        let EdgeSearch { edge, inside, outside, region, step, .. } = self;
        let (solid, region, step) = (edge.solid, *region, *step);
        self.face = if region == Region::Above { SolidFace::Inset } else { SolidFace::Shell };
        self.depth = match region {
            Region::Above => Some(-solid.inset_depth),
            Region::Below => Some(-solid.thickness_at(&outside.sample)),
            Region::Beside | Region::Inside => None,
        };
        if let Some(depth) = self.depth
            && (outside.sample.distance - depth).abs() <= ON_FACE * edge.voxel
        {
            return SearchStep::Found(edge.on_face(*outside, self.face), self.face);
        }
        let width = outside.t - inside.t;
        if width.abs() <= MIN_WIDTH {
            let (crossing, face) = edge.at_jump(*inside, *outside);
            return SearchStep::Found(crossing, face);
        }
        let share = match self.depth {
            // Some steps halve, so that a jump of the distance does not take for ever.
            Some(depth) if step < MAX_ROOT_STEPS && step % 4 != 3 => {
                let (a, b) = (inside.sample.distance - depth, outside.sample.distance - depth);
                // A little beyond the root, so that it is the outside end that gets near.
                let secant = (a / (a - b) + 1e-9).clamp(0.0, 1.0);
                let newton = self.last.and_then(|last| edge.newton(&last, depth));
                let share = newton.map(|t| (t - inside.t) / width);
                share.filter(|&share| share > 0.0 && share < 1.0).unwrap_or(secant)
            }
            None if region == Region::Beside && step < MAX_ROOT_STEPS => {
                edge.at_wall(inside, outside, step % 2 == 0).unwrap_or(0.5)
            }
            _ => 0.5,
        };
        SearchStep::Evaluate(inside.t + share * width)
    }

    /// Narrows the search by the sample that it needed.
    pub fn add_sample(&mut self, middle: EdgeSample) {
        let EdgeSearch { edge, inside, outside, .. } = self;
        self.step += 1;
        self.last = Some(middle);
        let region = edge.solid.classify(edge.at(middle.t), &middle.sample);
        if region != Region::Inside {
            (*outside, self.region) = (middle, region);
            return;
        }
        // As good as on the face, from the inside.
        if let Some(depth) = self.depth
            && (middle.sample.distance - depth).abs() <= ON_FACE * edge.voxel
        {
            self.found = Some((edge.on_face(middle, self.face), self.face));
        }
        *inside = middle;
    }
}

impl LatticeEdge<'_> {
    /// Returns the point at parameter `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        let mut p = self.start;
        p[self.axis as usize] += t * self.voxel;
        p
    }

    /// Returns the parameter at which the distance would be `depth` if it went on as it does at
    /// `end`: a Newton step.
    fn newton(&self, end: &EdgeSample, depth: f64) -> Option<f64> {
        let Sample { distance, closest, .. } = end.sample;
        let slope = (self.at(end.t) - closest)[self.axis as usize] / distance;
        let t = end.t + (depth - distance) / (slope * self.voxel);
        t.is_finite().then_some(t)
    }

    /// Returns the share of the way from the inner point to the outer one at which to look for the
    /// wall that the outer one is beyond.
    ///
    /// The first sample is a little beyond the wall's plane, the second a little before it. `None`
    /// where that leads nowhere, or where the second sample is due without the first.
    fn at_wall(&self, inside: &EdgeSample, outside: &EdgeSample, is_first: bool) -> Option<f64> {
        let wall = self.solid.boundary.wall(self.solid.distance.mesh(), &outside.sample);
        let across = (self.at(outside.t) - outside.sample.closest).dot(wall) / self.voxel;
        let crossed = outside.t - across / wall[self.axis as usize];
        let width = outside.t - inside.t;
        let is_next = (outside.t - crossed).abs() < 2.0 * WALL_PROBE;
        if !is_first && !is_next {
            return None;
        }
        let share =
            (crossed - inside.t + width.signum() * if is_next { -WALL_PROBE } else { WALL_PROBE }) / width;
        (share > 0.0 && share < 1.0).then_some(share)
    }

    /// Returns the crossing at a sample, with `normal`.
    fn crossing(&self, end: &EdgeSample, normal: DVec3) -> Crossing {
        Crossing { t: end.t, normal: normal.as_vec3().to_array(), triangle: end.sample.triangle }
    }

    /// Returns the crossing at a sample that is on the inset or the shell.
    fn on_face(&self, end: EdgeSample, face: SolidFace) -> Crossing {
        let gradient = self.gradient(&end);
        self.crossing(&end, if face == SolidFace::Inset { gradient } else { -gradient })
    }

    /// Returns the gradient of the distance at a sample.
    fn gradient(&self, end: &EdgeSample) -> DVec3 {
        self.solid.distance.gradient(self.at(end.t), &end.sample, MIN_WIDTH * self.voxel)
    }

    /// Returns the crossing where the closest point jumps from one part of S to another.
    fn at_jump(&self, inside: EdgeSample, outside: EdgeSample) -> (Crossing, SolidFace) {
        let distance = self.solid.distance;
        if let Some((depth, normal)) = self.solid.pillars.at(self.at(outside.t))
            && (depth - self.solid.inset_depth).abs() <= self.voxel * 1e-3
        {
            return (self.crossing(&outside, normal), SolidFace::Inset);
        }
        if self.solid.classify(self.at(outside.t), &outside.sample) == Region::Beside {
            let wall = self.solid.boundary.wall(distance.mesh(), &outside.sample);
            // Where the boundary of another part of S is as near, the medial plane of both is the
            // wall.
            let apart = (inside.sample.closest - outside.sample.closest).length();
            if wall != DVec3::ZERO && apart <= 0.1 * self.voxel {
                return (self.crossing(&outside, wall), SolidFace::Section);
            }
            return (self.crossing(&outside, self.medial_normal(&inside, &outside)), SolidFace::Section);
        }
        (self.crossing(&outside, self.medial_normal(&inside, &outside)), SolidFace::Medial)
    }

    /// Returns the normal of the medial plane between the closest points of both samples.
    fn medial_normal(&self, inside: &EdgeSample, outside: &EdgeSample) -> DVec3 {
        let away = |end: &EdgeSample| (self.at(end.t) - end.sample.closest).normalize_or_zero();
        let mut axis = DVec3::ZERO;
        axis[self.axis as usize] = (outside.t - inside.t).signum();
        (away(inside) - away(outside)).try_normalize().unwrap_or(axis)
    }
}
