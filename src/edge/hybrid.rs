//! The hybrid solver for one edge (\[LW11\] section V.A): analytic where the closest points of both ends
//! share a triangle, verified by a query, bisection otherwise, with a new analytic attempt after each
//! subdivision.

use super::analytic;
use super::shared::shared_triangle;
use super::statistics::{COUNTED_SUBDIVISIONS, EdgeStatistics};
use crate::distance::{Sample, SignedDistance};
use glam::DVec3;

/// A root is good when abs(phi) is below this many voxels. The promise is 1e-6; corners of the offset are
/// found by intersecting planes through the roots, which multiplies their errors.
pub(super) const TOLERANCE: f64 = 1e-7;

/// Bisection ends when the interval is shorter than this part of the edge. By then a continuous phi is
/// below the tolerance; what is left is a jump, or rounding far from the origin.
pub(super) const SHORTEST: f64 = 1e-9;

/// A grid edge, with what the band knows of its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridEdge {
    /// World positions of the end that is inside the offset solid and of the one outside.
    pub(super) inside: DVec3,
    pub(super) outside: DVec3,
    /// A triangle near each end, exact if `known`.
    pub(super) triangles: [NodeTriangle; 2],
}

/// The closest triangle of a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum NodeTriangle {
    /// From the band.
    Known(u32),
    /// The node is not in the band; some triangle to start from.
    Guess(u32),
}

/// The intersection of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// Position between the inside end (0) and the outside end (1).
    pub(super) t: f64,
    /// Unit normal, outward.
    pub(super) normal: DVec3,
}

/// One end of the interval that brackets the root.
#[derive(Clone, Copy)]
pub(super) struct End {
    /// Position between the inside end (0) and the outside end (1).
    pub(super) t: f64,
    pub(super) sample: Sample,
}

pub(super) struct Solver<'a> {
    pub(super) distance: &'a SignedDistance<'a>,
    pub(super) r: f64,
    pub(super) voxel: f64,
}

impl Solver<'_> {
    /// The intersection of `edge`.
    pub(super) fn solve(&self, edge: &GridEdge, statistics: &mut EdgeStatistics) -> Root {
        statistics.intersected += 1;
        let [inside, outside] = edge.triangles;
        let mut low = End { t: 0.0, sample: self.node(edge.inside, inside, statistics) };
        let mut high = End { t: 1.0, sample: self.node(edge.outside, outside, statistics) };
        // A node on the surface is the root; rounding may have given its distance either sign.
        if let Some(end) = [low, high].into_iter().find(|end| self.is_root(end)) {
            statistics.by_subdivision[0] += 1;
            return self.finish(edge, end);
        }
        // The band decided the signs; where an open mesh makes the distance disagree, nothing is bracketed.
        if self.phi(&low) >= 0.0 || self.phi(&high) < 0.0 {
            return self.jump(edge, 0.5, statistics);
        }
        let mut subdivisions = 0;
        loop {
            if let Some(root) = self.attempt(edge, &mut low, &mut high, statistics) {
                match statistics.by_subdivision.get_mut(subdivisions) {
                    Some(count) => *count += 1,
                    None => statistics.bisected += 1,
                }
                return self.finish(edge, root);
            }
            let middle = self.end(edge, 0.5 * (low.t + high.t), low.sample.triangle, statistics);
            subdivisions += 1;
            if self.is_root(&middle) {
                statistics.bisected += 1;
                return self.finish(edge, middle);
            }
            self.replace(&mut low, &mut high, middle);
            if high.t - low.t < SHORTEST {
                return self.collapsed(edge, low, high, statistics);
            }
        }
    }

    /// The analytic attempt between two ends: a verified root, or a tighter interval.
    fn attempt(
        &self,
        edge: &GridEdge,
        low: &mut End,
        high: &mut End,
        statistics: &mut EdgeStatistics,
    ) -> Option<End> {
        let shared = shared_triangle(self.distance, &low.sample, &high.sample)?;
        let triangle = self.distance.ssvh().triangle(shared);
        let s = analytic::root(triangle, self.at(edge, low.t), self.at(edge, high.t), self.r)?;
        let t = low.t + s * (high.t - low.t);
        let root = self.end(edge, t, shared, statistics);
        if self.is_root(&root) {
            return Some(root);
        }
        // Not a root of the whole mesh, but on a known side: as good as a subdivision, and already paid.
        self.replace(low, high, root);
        None
    }

    /// The interval shrank to nothing: a root that rounding keeps from being recognised, or a jump.
    pub(super) fn collapsed(
        &self,
        edge: &GridEdge,
        low: End,
        high: End,
        statistics: &mut EdgeStatistics,
    ) -> Root {
        let rounding = 1e-12 * (edge.inside.abs().max_element() + self.r.abs());
        if self.phi(&high) - self.phi(&low) > 4.0 * SHORTEST * self.voxel + rounding {
            return self.jump(edge, 0.5 * (low.t + high.t), statistics);
        }
        statistics.bisected += 1;
        self.finish(edge, low)
    }

    pub(super) fn jump(&self, edge: &GridEdge, t: f64, statistics: &mut EdgeStatistics) -> Root {
        statistics.sign_jumps += 1;
        Root { t, normal: (edge.outside - edge.inside) / self.voxel }
    }

    pub(super) fn finish(&self, edge: &GridEdge, end: End) -> Root {
        // Directions to a closest point nearer than the root's own error mean nothing.
        let vanishing = 1e3 * TOLERANCE * self.voxel;
        let normal = self.distance.gradient(self.at(edge, end.t), &end.sample, vanishing);
        Root { t: end.t, normal }
    }

    pub(super) fn is_root(&self, end: &End) -> bool {
        self.phi(end).abs() <= TOLERANCE * self.voxel
    }

    pub(super) fn phi(&self, end: &End) -> f64 {
        end.sample.distance - self.r
    }

    fn at(&self, edge: &GridEdge, t: f64) -> DVec3 {
        edge.inside + (edge.outside - edge.inside) * t
    }

    pub(super) fn replace(&self, low: &mut End, high: &mut End, end: End) {
        *(if self.phi(&end) < 0.0 { low } else { high }) = end;
    }

    pub(super) fn end(&self, edge: &GridEdge, t: f64, guess: u32, statistics: &mut EdgeStatistics) -> End {
        statistics.queries += 1;
        End { t, sample: self.distance.at(self.at(edge, t), guess) }
    }

    pub(super) fn node(&self, p: DVec3, triangle: NodeTriangle, statistics: &mut EdgeStatistics) -> Sample {
        match triangle {
            NodeTriangle::Known(t) => self.distance.from_triangle(p, t),
            NodeTriangle::Guess(t) => {
                statistics.queries += 1;
                self.distance.at(p, t)
            }
        }
    }
}

const _: () = assert!(COUNTED_SUBDIVISIONS == 6, "Table V counts up to six subdivisions");
