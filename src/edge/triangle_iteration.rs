//! A faster way to the roots of the hybrid solver: fixed-point iteration on the closest triangle.
//!
//! The root is solved for on one triangle. A query at that root names the triangle that is closest
//! there, and the iteration goes on with it, until it is the triangle that was solved for.
//!
//! The hybrid solver ([`hybrid`](super::hybrid)) evaluates both ends of an edge and halves it when
//! their triangles do not do; here every question is asked where one triangle has the root, which
//! is where the whole mesh has it most of the time. Where that leads nowhere, the hybrid solver
//! takes over.

use super::closed_form;
use super::hybrid::{End, GridEdge, MIN_INTERVAL, NodeTriangle, ROOT_TOLERANCE, Root, Solver};
use super::statistics::EdgeStatistics;
use crate::candidates::Candidates;
use glam::DVec3;

/// The most triangles in an iteration before the hybrid solver takes over. More than five have not
/// been seen on scanned models.
const MAX_ITERATIONS: usize = 8;

/// The root that one triangle alone would have.
#[derive(Clone, Copy)]
struct Proposal {
    /// Position between the inside end (0) and the outside end (1).
    t: f64,
    triangle: u32,
}

impl Solver<'_> {
    /// Returns the intersection of `edge`.
    pub(super) fn iterate(&self, edge: &GridEdge, statistics: &mut EdgeStatistics) -> Root {
        let tried = self.first(edge).map(|p| self.end(edge, p.t, p.triangle, statistics));
        self.iterate_from(edge, tried, statistics)
    }

    /// The intersections of up to eight edges that are near each other, each as
    /// [`iterate`](Self::iterate) finds it. What they try first is verified together, by the
    /// candidates that they have in common, if any.
    pub(super) fn iterate8(
        &self,
        edges: &[GridEdge],
        near: Option<Candidates<'_>>,
        statistics: &mut EdgeStatistics,
        roots: &mut [Root; 8],
    ) {
        let mut points = [DVec3::ZERO; 8];
        let mut positions = [None; 8];
        let (mut proposed, mut guess) = (0, 0);
        for (edge, position) in edges.iter().zip(&mut positions) {
            if let Some(Proposal { t, triangle }) = self.first(edge) {
                points[proposed] = self.at(edge, t);
                guess = triangle;
                *position = Some(t);
                proposed += 1;
            }
        }
        // Lanes that are left over repeat one that is used.
        let used = points[0];
        points[proposed..].fill(used);
        statistics.queries += proposed as u64;
        let ssvh = self.distance.ssvh();
        // The triangle that was solved for is that near, and so is the closest one.
        let expected = self.r.abs() + ROOT_TOLERANCE * self.voxel;
        let hits = (proposed > 0).then(|| match near {
            Some(near) => near.closest8(ssvh, &points, proposed, expected),
            None => ssvh.closest8(&points, guess),
        });
        let mut answers = points.iter().zip(hits.iter().flatten());
        for ((edge, position), root) in edges.iter().zip(positions).zip(roots) {
            let tried = position.and_then(|t| {
                let (&p, hit) = answers.next()?;
                Some(End { t, sample: self.distance.from_triangle(p, hit.triangle) })
            });
            *root = self.iterate_from(edge, tried, statistics);
        }
    }

    /// Returns the root on the triangle of one end.
    fn first(&self, edge: &GridEdge) -> Option<Proposal> {
        edge.triangles.into_iter().find_map(|triangle| {
            let (NodeTriangle::Known(triangle) | NodeTriangle::Guess(triangle)) = triangle;
            let t = self.root_on(edge, triangle, [0.0, 1.0])?;
            Some(Proposal { t, triangle })
        })
    }

    /// Returns the position of the root on `triangle` between two positions.
    fn root_on(&self, edge: &GridEdge, triangle: u32, [low, high]: [f64; 2]) -> Option<f64> {
        let triangle = self.distance.ssvh().triangle(triangle);
        let s = closed_form::root(triangle, self.at(edge, low), self.at(edge, high), self.r)?;
        Some(low + s * (high - low))
    }

    fn iterate_from(&self, edge: &GridEdge, mut tried: Option<End>, statistics: &mut EdgeStatistics) -> Root {
        statistics.intersected += 1;
        let (mut low, mut high) = (0.0, 1.0);
        for attempts in 0..MAX_ITERATIONS {
            let Some(end) = tried else { break };
            if self.is_root(&end) {
                match statistics.by_subdivision.get_mut(attempts) {
                    Some(count) => *count += 1,
                    None => statistics.bisected += 1,
                }
                return self.finish(edge, end);
            }
            *(if self.phi(&end) < 0.0 { &mut low } else { &mut high }) = end.t;
            if high - low < MIN_INTERVAL {
                break;
            }
            let triangle = end.sample.triangle;
            let t = self.root_on(edge, triangle, [low, high]);
            tried = t.map(|t| self.end(edge, t, triangle, statistics));
        }
        self.solve_counted(edge, statistics)
    }
}
