//! Triangulations of strips that meet nothing, by exact tests.

use super::strip::{Step, Strip};
use crate::geom::box_tree::BoxTree;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashSet};

/// Maximum number of triangulations of the strips, each without the triangles that met something
/// before. Most conflicts are gone after each; what is left after so many goes round in circles.
const MAX_TRIES: usize = 12;

/// A triangle of a strip or a cap that meets something.
#[derive(Debug)]
pub(crate) struct Conflict {
    /// Rim vertices of the triangle.
    pub rim: Vec<u32>,
    /// Triangles of the contour that the triangle meets.
    pub contour: Vec<usize>,
    /// A point near the conflict.
    pub at: [f64; 3],
    /// Number of the strip; `None` for a cap.
    pub strip: Option<usize>,
}

/// The outcome of a fitting.
#[derive(Debug)]
pub(crate) enum Fit {
    /// Triangles that meet nothing.
    Triangles(Vec<[u32; 3]>),
    /// Conflicts that no choice of triangles avoids.
    Conflicts(Vec<Conflict>),
}

/// Patch and contour, which strips and caps must not meet.
pub(crate) struct Surroundings<'a> {
    /// The triangles of the patch, then those of the contour.
    pub mesh: &'a TriMesh,
    /// Boxes around the triangles of `mesh`.
    pub tree: &'a BoxTree,
    /// Number of triangles of the patch.
    pub patch: usize,
    /// Whether each triangle of the contour is kept.
    pub kept: &'a [bool],
}

/// Triangles of strips that were found to meet nothing of their surroundings. They stay clear while
/// nothing is added to these.
pub(crate) type ClearTriangles = HashSet<[u32; 3]>;

impl Surroundings<'_> {
    /// Finds triangles of the strips that meet neither their surroundings nor each other.
    pub fn fit_strips(
        &self,
        strips: &mut [Strip],
        clear: &mut ClearTriangles,
        run: &RunSettings,
    ) -> Result<Fit, Cancelled> {
        let mut paths: Vec<Vec<Step>> = vec![Vec::new(); strips.len()];
        let mut stale: Vec<bool> = vec![true; strips.len()];
        let mut bad: Vec<(usize, Step)> = Vec::new();
        for tries in 0.. {
            run.check()?;
            let mut stuck = false;
            let again = strips.par_iter().zip(&stale).map(|(strip, &stale)| stale.then(|| strip.cheapest()));
            for (path, again) in paths.iter_mut().zip(again.collect::<Vec<_>>()) {
                match again {
                    Some(Some(found)) => *path = found,
                    Some(None) => stuck = true,
                    None => {}
                }
            }
            if stuck || tries == MAX_TRIES {
                if bad.is_empty() {
                    // No path even without conflicts: the ends are too far from each other.
                    bad.extend(strips.iter().enumerate().map(|(n, _)| (n, Step::Rim(0, 0))));
                }
                let conflicts = bad.iter().map(|&(n, step)| self.conflict(&strips[n], n, step)).collect();
                return Ok(Fit::Conflicts(conflicts));
            }
            // Strip and step of each triangle.
            let steps: Vec<(usize, Step)> =
                paths.iter().enumerate().flat_map(|(n, path)| path.iter().map(move |&s| (n, s))).collect();
            let triangles: Vec<[u32; 3]> = steps.iter().map(|&(n, s)| strips[n].triangle(s)).collect();
            bad = steps
                .par_iter()
                .zip(&triangles)
                .with_min_len(16)
                .filter(|&(_, t)| !clear.contains(t) && self.meets(*t))
                .map(|(&step, _)| step)
                .collect();
            let is_bad: BTreeSet<(usize, Step)> = bad.iter().copied().collect();
            clear.extend(
                steps.iter().zip(&triangles).filter(|&(step, _)| !is_bad.contains(step)).map(|(_, &t)| t),
            );
            if bad.is_empty() {
                let all = TriMesh { vertices: self.mesh.vertices.clone(), triangles };
                bad = costlier_of_pairs(&all, &steps, strips, run)?;
                if bad.is_empty() {
                    bad = costliest_at_edges(&all.triangles, &steps, strips);
                }
                if bad.is_empty() {
                    return Ok(Fit::Triangles(all.triangles));
                }
            }
            stale.fill(false);
            for &(n, step) in &bad {
                stale[n] = true;
                strips[n].forbidden.insert(step);
            }
        }
        unreachable!("tries end")
    }

    /// Calls `visit` with each triangle of the surroundings that triangle `t` meets.
    pub fn meeting(&self, t: [u32; 3], mut visit: impl FnMut(usize)) {
        let corners = t.map(|v| self.mesh.vertices[v as usize]);
        let [a, b, c] = corners.map(DVec3::from);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        self.tree.meeting([lo, hi], |n| {
            let n = n as usize;
            let is_there = n < self.patch || self.kept[n - self.patch];
            if is_there && meeting_point(t, corners, self.mesh.triangles[n], self.mesh.corners(n)).is_some() {
                visit(n);
            }
        });
    }

    /// Whether triangle `t` has no area or meets the surroundings.
    pub fn meets(&self, t: [u32; 3]) -> bool {
        if projection_axis(t.map(|v| self.mesh.vertices[v as usize])).is_none() {
            return true;
        }
        let mut found = false;
        self.meeting(t, |_| found = true);
        found
    }

    /// Returns the conflict of a step of strip number `number`.
    fn conflict(&self, strip: &Strip, number: usize, step: Step) -> Conflict {
        let triangle = strip.triangle(step);
        let mut contour = Vec::new();
        self.meeting(triangle, |n| contour.extend(n.checked_sub(self.patch)));
        let (Step::Boundary(_, j) | Step::Rim(_, j)) = step;
        let rim = match step {
            Step::Boundary(..) => vec![strip.rim.vertices[j as usize]],
            Step::Rim(..) => strip.rim.vertices[j as usize..=j as usize + 1].to_vec(),
        };
        Conflict { rim, contour, at: self.mesh.vertices[triangle[2] as usize], strip: Some(number) }
    }
}

/// Returns the costliest triangle at each edge that more than two triangles of strips have.
///
/// A loop that comes through a vertex twice can lead to such an edge: triangles that share an edge
/// need not meet anywhere else.
fn costliest_at_edges(
    triangles: &[[u32; 3]],
    steps: &[(usize, Step)],
    strips: &[Strip],
) -> Vec<(usize, Step)> {
    let edges_of = |n: usize| [[0, 1], [1, 2], [2, 0]].map(|edge| edge.map(|k: usize| triangles[n][k]));
    let mut edges: Vec<([u32; 2], usize)> =
        (0..triangles.len()).flat_map(|n| edges_of(n).map(|[a, b]| ([a.min(b), a.max(b)], n))).collect();
    edges.sort_unstable();
    let cost = |n: usize| strips[steps[n].0].cost(steps[n].1);
    let crowded = edges.chunk_by(|a, b| a.0 == b.0).filter(|at_edge| at_edge.len() > 2);
    let costliest = crowded
        .filter_map(|at_edge| at_edge.iter().map(|&(_, n)| n).max_by(|&a, &b| cost(a).total_cmp(&cost(b))));
    costliest.map(|n| steps[n]).collect()
}

/// Returns the costlier one of each two triangles of strips that meet.
fn costlier_of_pairs(
    all: &TriMesh,
    steps: &[(usize, Step)],
    strips: &[Strip],
    run: &RunSettings,
) -> Result<Vec<(usize, Step)>, Cancelled> {
    let tree = BoxTree::new(&all.vertices, &all.triangles, (0..all.triangles.len() as u32).into_par_iter());
    let pairs = tree.pairs(run, Vec::new, |found: &mut Vec<[u32; 2]>, a, b| {
        let (va, vb) = (all.triangles[a as usize], all.triangles[b as usize]);
        if meeting_point(va, all.corners(a as usize), vb, all.corners(b as usize)).is_some() {
            found.push([a, b]);
        }
    })?;
    let costlier = |pair: [u32; 2]| {
        let [a, b] = pair.map(|t| steps[t as usize]);
        if strips[a.0].cost(a.1) > strips[b.0].cost(b.1) { a } else { b }
    };
    Ok(pairs.into_iter().flatten().map(costlier).collect())
}
