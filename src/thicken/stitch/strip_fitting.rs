//! Strips that meet nothing, by exact tests.

use super::strip::{Ribbon, Step};
use crate::geom::box_tree::BoxTree;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashSet};

/// Strips are chosen anew this often without the triangles that meet something. Each time most conflicts are gone; what
/// is left after so many goes round in circles.
const TRIES: usize = 12;

/// A step of a ribbon that does not fit.
#[derive(Debug)]
pub(crate) struct Conflict {
    /// Rim vertices at it.
    pub rim: Vec<u32>,
    /// The section's triangles that it meets.
    pub section: Vec<usize>,
    pub at: [f64; 3],
    /// The strip, if it is one's.
    pub ribbon: Option<usize>,
}

/// What ribbons must not meet.
pub(crate) struct Around<'a> {
    pub mesh: &'a TriMesh,
    pub tree: &'a BoxTree,
    /// The first triangles are those of the patch.
    pub patch: usize,
    /// Whether each of the others is there.
    pub kept: &'a [bool],
}

/// Triangles of strips that were found to meet nothing that is there. They stay so while nothing is added.
pub(crate) type Free = HashSet<[u32; 3]>;

impl Around<'_> {
    /// The triangles of ribbons that meet nothing, or where they would.
    pub fn fit(
        &self,
        ribbons: &mut [Ribbon],
        free: &mut Free,
        run: &RunSettings,
    ) -> Result<Result<Vec<[u32; 3]>, Vec<Conflict>>, Cancelled> {
        let mut paths: Vec<Vec<Step>> = vec![Vec::new(); ribbons.len()];
        let mut stale: Vec<bool> = vec![true; ribbons.len()];
        let mut bad: Vec<(usize, Step)> = Vec::new();
        for tries in 0.. {
            run.check()?;
            let mut stuck = false;
            let again =
                ribbons.par_iter().zip(&stale).map(|(ribbon, &stale)| stale.then(|| ribbon.cheapest()));
            for (path, again) in paths.iter_mut().zip(again.collect::<Vec<_>>()) {
                match again {
                    Some(Some(found)) => *path = found,
                    Some(None) => stuck = true,
                    None => {}
                }
            }
            if stuck || tries == TRIES {
                if bad.is_empty() {
                    // Not even without conflicts: the ends are out of reach of each other.
                    bad.extend(ribbons.iter().enumerate().map(|(n, _)| (n, Step::Rim(0, 0))));
                }
                let conflicts = bad.iter().map(|&(n, step)| self.conflict(ribbons, n, step)).collect();
                return Ok(Err(conflicts));
            }
            // Which ribbon and step each triangle is.
            let steps: Vec<(usize, Step)> =
                paths.iter().enumerate().flat_map(|(n, path)| path.iter().map(move |&s| (n, s))).collect();
            let triangles: Vec<[u32; 3]> = steps.iter().map(|&(n, s)| ribbons[n].triangle(s)).collect();
            bad = steps
                .par_iter()
                .zip(&triangles)
                .with_min_len(16)
                .filter(|&(_, t)| !free.contains(t) && self.meets(*t))
                .map(|(&step, _)| step)
                .collect();
            let is_bad: BTreeSet<(usize, Step)> = bad.iter().copied().collect();
            free.extend(
                steps.iter().zip(&triangles).filter(|&(step, _)| !is_bad.contains(step)).map(|(_, &t)| t),
            );
            if bad.is_empty() {
                let strip = TriMesh { vertices: self.mesh.vertices.clone(), triangles };
                bad = costlier_of_pairs(&strip, &steps, ribbons, run)?;
                if bad.is_empty() {
                    bad = costliest_at_edges(&strip.triangles, &steps, ribbons);
                }
                if bad.is_empty() {
                    return Ok(Ok(strip.triangles));
                }
            }
            stale.fill(false);
            for &(n, step) in &bad {
                stale[n] = true;
                ribbons[n].forbidden.insert(step);
            }
        }
        unreachable!("tries end")
    }

    /// Calls `visit` with each triangle near triangle `t` of the strip that it meets.
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

    /// Whether triangle `t` of the strip has no area or meets what is there.
    pub fn meets(&self, t: [u32; 3]) -> bool {
        if projection_axis(t.map(|v| self.mesh.vertices[v as usize])).is_none() {
            return true;
        }
        let mut found = false;
        self.meeting(t, |_| found = true);
        found
    }

    fn conflict(&self, ribbons: &[Ribbon], number: usize, step: Step) -> Conflict {
        let ribbon = &ribbons[number];
        let triangle = ribbon.triangle(step);
        let mut section = Vec::new();
        self.meeting(triangle, |n| section.extend(n.checked_sub(self.patch)));
        let (Step::Boundary(_, j) | Step::Rim(_, j)) = step;
        let rim = match step {
            Step::Boundary(..) => vec![ribbon.rim.vertices[j as usize]],
            Step::Rim(..) => ribbon.rim.vertices[j as usize..=j as usize + 1].to_vec(),
        };
        Conflict { rim, section, at: self.mesh.vertices[triangle[2] as usize], ribbon: Some(number) }
    }
}

/// Of the triangles of the strip at each edge that more than two of them have, the costliest one. A loop that
/// comes through a vertex twice can lead to that: triangles that share an edge need not meet anywhere else.
fn costliest_at_edges(
    triangles: &[[u32; 3]],
    steps: &[(usize, Step)],
    ribbons: &[Ribbon],
) -> Vec<(usize, Step)> {
    let sides = |n: usize| [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|k: usize| triangles[n][k]));
    let mut edges: Vec<([u32; 2], usize)> =
        (0..triangles.len()).flat_map(|n| sides(n).map(|[a, b]| ([a.min(b), a.max(b)], n))).collect();
    edges.sort_unstable();
    let cost = |n: usize| ribbons[steps[n].0].cost_of(steps[n].1);
    let crowded = edges.chunk_by(|a, b| a.0 == b.0).filter(|at_edge| at_edge.len() > 2);
    let costliest = crowded
        .filter_map(|at_edge| at_edge.iter().map(|&(_, n)| n).max_by(|&a, &b| cost(a).total_cmp(&cost(b))));
    costliest.map(|n| steps[n]).collect()
}

/// Of each two triangles of the strip that meet the costlier one.
fn costlier_of_pairs(
    strip: &TriMesh,
    steps: &[(usize, Step)],
    ribbons: &[Ribbon],
    run: &RunSettings,
) -> Result<Vec<(usize, Step)>, Cancelled> {
    let own =
        BoxTree::new(&strip.vertices, &strip.triangles, (0..strip.triangles.len() as u32).into_par_iter());
    let pairs = own.pairs(run, Vec::new, |found: &mut Vec<[u32; 2]>, a, b| {
        let (va, vb) = (strip.triangles[a as usize], strip.triangles[b as usize]);
        if meeting_point(va, strip.corners(a as usize), vb, strip.corners(b as usize)).is_some() {
            found.push([a, b]);
        }
    })?;
    let costlier = |pair: [u32; 2]| {
        let [a, b] = pair.map(|t| steps[t as usize]);
        if ribbons[a.0].cost_of(a.1) > ribbons[b.0].cost_of(b.1) { a } else { b }
    };
    Ok(pairs.into_iter().flatten().map(costlier).collect())
}
