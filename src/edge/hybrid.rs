//! The hybrid solver for one edge (\[LW11\] section V.A).
//!
//! Where the closest points of both ends share a triangle, the root on it is taken in closed form
//! and verified by a query. Otherwise the edge is halved, with a new attempt in closed form after
//! each subdivision.

use super::shared_triangle::shared_triangle;
use super::statistics::{COUNTED_SUBDIVISIONS, EdgeStatistics};
use super::{Crossing, closed_form};
use crate::candidates::Candidates;
use crate::distance::{Sample, SignedDistance};
use glam::DVec3;

/// Size of phi, in voxels, below which a root is good. The promise is 1e-6; corners of the offset
/// are found by intersecting planes through the roots, which multiplies their errors.
pub(super) const ROOT_TOLERANCE: f64 = 1e-7;

/// Length of the interval, relative to the edge, below which bisection ends. By then a continuous
/// phi is below the tolerance; a larger phi is a jump, or rounding far from the origin.
pub(super) const MIN_INTERVAL: f64 = 1e-9;

/// A grid edge, with the triangles that the band knows at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct GridEdge<'a> {
    /// World positions of the end that is inside the offset solid and of the one outside.
    pub(super) inside: DVec3,
    pub(super) outside: DVec3,
    /// A triangle near each end, the closest one if it is known.
    pub(super) triangles: [NodeTriangle; 2],
    /// Triangles that can be closest to a point of the edge, where they are known.
    pub(super) candidates: Option<Candidates<'a>>,
    /// Direction of the edge along its axis, from the inside to the outside.
    pub(super) direction: Direction,
    /// A triangle near the edge.
    pub(super) hint: u32,
}

/// The direction in which an edge leaves the offset solid, going up its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// The edge goes out of the solid.
    Out,
    /// The edge goes into the solid.
    In,
}

impl GridEdge<'_> {
    /// Returns the crossing at a root.
    pub(super) fn crossing(&self, root: Root) -> Crossing {
        let t = match self.direction {
            Direction::Out => root.t,
            Direction::In => 1.0 - root.t,
        };
        Crossing { t, normal: root.normal.as_vec3().to_array(), triangle: root.triangle }
    }
}

/// The closest triangle of a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum NodeTriangle {
    /// The closest triangle, as the band knows it.
    Known(u32),
    /// Some triangle to start from: the node is not in the band.
    Guess(u32),
}

/// The intersection of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    /// Position between the inside end (0) and the outside end (1).
    pub(super) t: f64,
    /// Unit normal, outward.
    pub(super) normal: DVec3,
    /// The closest triangle there.
    pub(super) triangle: u32,
}

/// One end of the interval that brackets the root.
#[derive(Clone, Copy)]
pub(super) struct End {
    /// Position between the inside end (0) and the outside end (1).
    pub(super) t: f64,
    pub(super) sample: Sample,
}

/// The two ends of the interval that brackets the root.
#[derive(Clone, Copy)]
struct Bracket {
    low: End,
    high: End,
}

/// The root that one triangle alone would have.
#[derive(Clone, Copy)]
struct Proposal {
    /// Position between the inside end (0) and the outside end (1).
    t: f64,
    triangle: u32,
}

pub(super) struct Solver<'a> {
    pub(super) distance: &'a SignedDistance<'a>,
    pub(super) r: f64,
    pub(super) voxel: f64,
}

impl Solver<'_> {
    /// Returns the intersection of `edge`.
    pub(super) fn solve(&self, edge: &GridEdge, statistics: &mut EdgeStatistics) -> Root {
        statistics.intersected += 1;
        self.solve_counted(edge, statistics)
    }

    /// Returns the intersection of an edge that has been counted.
    pub(super) fn solve_counted(&self, edge: &GridEdge, statistics: &mut EdgeStatistics) -> Root {
        match self.bracket(edge, statistics) {
            Ok(bracket) => {
                let tried = self.propose(edge, &bracket).map(|p| self.end(edge, p.t, p.triangle, statistics));
                self.refine(edge, bracket, tried, statistics)
            }
            Err(root) => root,
        }
    }

    /// Returns the ends of an edge with their distances, or the root at once where there is nothing
    /// to solve.
    fn bracket(&self, edge: &GridEdge, statistics: &mut EdgeStatistics) -> Result<Bracket, Root> {
        let [inside, outside] = edge.triangles;
        let low = End { t: 0.0, sample: self.node(edge, edge.inside, inside, statistics) };
        let high = End { t: 1.0, sample: self.node(edge, edge.outside, outside, statistics) };
        // A node on the surface is the root; rounding may have given its distance either sign.
        if let Some(end) = [low, high].into_iter().find(|end| self.is_root(end)) {
            statistics.by_subdivision[0] += 1;
            return Err(self.finish(edge, end));
        }
        // The band decided the signs; where an open mesh makes the distance disagree, nothing is
        // bracketed.
        if self.phi(&low) >= 0.0 || self.phi(&high) < 0.0 {
            return Err(self.jump(edge, 0.5, statistics));
        }
        Ok(Bracket { low, high })
    }

    /// Returns the root that the closed forms propose between two ends.
    fn propose(&self, edge: &GridEdge, Bracket { low, high }: &Bracket) -> Option<Proposal> {
        let triangle = shared_triangle(self.distance, &low.sample, &high.sample)?;
        let ends = [self.at(edge, low.t), self.at(edge, high.t)];
        let s = closed_form::root(self.distance.ssvh().triangle(triangle), ends[0], ends[1], self.r)?;
        Some(Proposal { t: low.t + s * (high.t - low.t), triangle })
    }

    /// Refines the bracket by halving and by attempts in closed form until it has the root. `tried`
    /// is the first attempt, if there was one: the root, or an end of a tighter bracket.
    fn refine(
        &self,
        edge: &GridEdge,
        Bracket { mut low, mut high }: Bracket,
        mut tried: Option<End>,
        statistics: &mut EdgeStatistics,
    ) -> Root {
        let mut subdivisions = 0;
        loop {
            if let Some(root) = tried {
                if self.is_root(&root) {
                    match statistics.by_subdivision.get_mut(subdivisions) {
                        Some(count) => *count += 1,
                        None => statistics.bisected += 1,
                    }
                    return self.finish(edge, root);
                }
                // Not a root of the whole mesh, but on a known side: as good as a subdivision, and
                // already paid.
                self.replace(&mut low, &mut high, root);
            }
            if self.is_out_of_reach(edge, &low, &high) {
                return self.jump(edge, 0.5 * (low.t + high.t), statistics);
            }
            let middle = self.end(edge, 0.5 * (low.t + high.t), low.sample.triangle, statistics);
            subdivisions += 1;
            if self.is_root(&middle) {
                statistics.bisected += 1;
                return self.finish(edge, middle);
            }
            self.replace(&mut low, &mut high, middle);
            if high.t - low.t < MIN_INTERVAL {
                return self.collapsed(edge, low, high, statistics);
            }
            let proposal = self.propose(edge, &Bracket { low, high });
            tried = proposal.map(|p| self.end(edge, p.t, p.triangle, statistics));
        }
    }

    /// Whether neither end can come to zero within the interval. The distance changes by no more
    /// than the way, so the sign jumps.
    fn is_out_of_reach(&self, edge: &GridEdge, low: &End, high: &End) -> bool {
        let rounding = 1e-12 * (edge.inside.abs().max_element() + self.r.abs());
        let way = (high.t - low.t) * self.voxel + rounding;
        self.phi(low) < -way && self.phi(high) > way
    }

    /// Returns the root of an interval that shrank to nothing: a root that rounding keeps from
    /// being recognised, or a jump.
    pub(super) fn collapsed(
        &self,
        edge: &GridEdge,
        low: End,
        high: End,
        statistics: &mut EdgeStatistics,
    ) -> Root {
        let rounding = 1e-12 * (edge.inside.abs().max_element() + self.r.abs());
        if self.phi(&high) - self.phi(&low) > 4.0 * MIN_INTERVAL * self.voxel + rounding {
            return self.jump(edge, 0.5 * (low.t + high.t), statistics);
        }
        statistics.bisected += 1;
        self.finish(edge, low)
    }

    pub(super) fn jump(&self, edge: &GridEdge, t: f64, statistics: &mut EdgeStatistics) -> Root {
        statistics.sign_jumps += 1;
        Root { t, normal: DVec3::ZERO, triangle: edge.hint }
    }

    pub(super) fn finish(&self, edge: &GridEdge, end: End) -> Root {
        // Directions to a closest point nearer than the root's own error mean nothing.
        let vanishing = 1e3 * ROOT_TOLERANCE * self.voxel;
        let normal = self.distance.gradient(self.at(edge, end.t), &end.sample, vanishing);
        Root { t: end.t, normal, triangle: end.sample.triangle }
    }

    pub(super) fn is_root(&self, end: &End) -> bool {
        self.phi(end).abs() <= ROOT_TOLERANCE * self.voxel
    }

    pub(super) fn phi(&self, end: &End) -> f64 {
        end.sample.distance - self.r
    }

    pub(super) fn at(&self, edge: &GridEdge, t: f64) -> DVec3 {
        edge.inside + (edge.outside - edge.inside) * t
    }

    pub(super) fn replace(&self, low: &mut End, high: &mut End, end: End) {
        *(if self.phi(&end) < 0.0 { low } else { high }) = end;
    }

    pub(super) fn end(&self, edge: &GridEdge, t: f64, guess: u32, statistics: &mut EdgeStatistics) -> End {
        statistics.queries += 1;
        End { t, sample: self.sample(edge, self.at(edge, t), guess) }
    }

    fn sample(&self, edge: &GridEdge, p: DVec3, guess: u32) -> Sample {
        match edge.candidates {
            Some(candidates) => {
                let hit = candidates.closest(self.distance.ssvh(), p);
                self.distance.from_triangle(p, hit.triangle)
            }
            None => self.distance.at(p, guess),
        }
    }

    pub(super) fn node(
        &self,
        edge: &GridEdge,
        p: DVec3,
        triangle: NodeTriangle,
        statistics: &mut EdgeStatistics,
    ) -> Sample {
        match triangle {
            NodeTriangle::Known(t) => self.distance.from_triangle(p, t),
            NodeTriangle::Guess(t) => {
                statistics.queries += 1;
                self.sample(edge, p, t)
            }
        }
    }
}

const _: () = assert!(COUNTED_SUBDIVISIONS == 6, "Table V counts up to six subdivisions");
