//! Joins the boundary of S to the rims of the section.

use super::boundary::Boundary;
use super::curve::Curve;
use super::open_mesh::OpenMesh;
use super::ribbon::{Ribbon, Side, Step};
use super::unsuitable::{Blocked, Obstacle};
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::verify::boxes::BoxTree;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// How a rim may lie to the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// A rim's vertex is at most this far from the boundary, in model units.
    pub across: f64,
    /// A rung leads at most this far along the boundary beyond the next vertices.
    pub along: f64,
}

/// Strips are chosen anew this often without the triangles that meet something. Each time most conflicts are gone; what
/// is left after so many goes round in circles.
const TRIES: usize = 40;

/// Pairs each rim with a boundary loop. Vertices of the rims are numbered on from `first`.
pub(super) fn ribbons(
    patch: &TriMesh,
    boundary: &Boundary,
    open: &OpenMesh,
    first: u32,
    reach: Reach,
) -> Result<Vec<Ribbon>, Blocked> {
    let curve = Curve::new(patch, boundary);
    let mut rim_of: Vec<Option<usize>> = vec![None; boundary.loops.len()];
    let mut ribbons = Vec::with_capacity(open.rims.len());
    for (number, rim) in open.rims.iter().enumerate() {
        let points: Vec<DVec3> = rim.iter().map(|&v| DVec3::from(open.mesh.vertices[v as usize])).collect();
        let closest: Vec<_> = points.par_iter().with_min_len(64).map(|&p| curve.closest(p)).collect();
        if let Some(far) = closest.iter().position(|c| c.distance > reach.across) {
            return Err(Blocked { obstacle: Obstacle::Sheets, at: points[far].to_array() });
        }
        if let Some(other) = closest.iter().position(|c| c.number != closest[0].number) {
            return Err(Blocked { obstacle: Obstacle::Loops, at: points[other].to_array() });
        }
        let at = points[0].to_array();
        let loops = closest[0].number as usize;
        if rim_of[loops].replace(number).is_some() {
            return Err(Blocked { obstacle: Obstacle::Loops, at });
        }
        // Against the direction of the section's triangles.
        let count = rim.len();
        let start = (0..count)
            .min_by(|&a, &b| closest[a].distance.total_cmp(&closest[b].distance))
            .unwrap_or_default();
        let order: Vec<usize> = (0..=count).map(|j| (start + count - j % count) % count).collect();
        let arcs = curve.arcs(loops as u32);
        let around = curve.vertices(loops as u32);
        let whole = arcs[around.len()];
        // The boundary begins with the vertex before the first rim vertex's closest point.
        let begin = arcs.partition_point(|&arc| arc <= closest[start].arc).clamp(1, around.len()) - 1;
        let boundary_side = Side {
            vertices: (0..=around.len()).map(|i| around[(begin + i) % around.len()]).collect(),
            points: (0..=around.len())
                .map(|i| DVec3::from(patch.vertices[around[(begin + i) % around.len()] as usize]))
                .collect(),
            arcs: (0..=around.len())
                .map(|i| {
                    let at = begin + i;
                    let turns = if at >= around.len() { whole } else { 0.0 };
                    arcs[at % around.len()] - arcs[begin] + turns
                })
                .collect(),
        };
        let mut rim_arcs = Vec::with_capacity(count + 1);
        let mut arc = closest[start].arc - arcs[begin];
        rim_arcs.push(arc);
        for pair in order.windows(2) {
            let mut step = closest[pair[1]].arc - closest[pair[0]].arc;
            step -= whole * (step / whole).round();
            arc += step;
            rim_arcs.push(arc);
        }
        if ((arc - rim_arcs[0]) / whole - 1.0).abs() > 0.01 {
            return Err(Blocked { obstacle: Obstacle::Loops, at });
        }
        let rim_side = Side {
            vertices: order.iter().map(|&j| first + rim[j]).collect(),
            points: order.iter().map(|&j| points[j]).collect(),
            arcs: rim_arcs,
        };
        ribbons.push(Ribbon {
            boundary: boundary_side,
            rim: rim_side,
            reach: reach.along,
            forbidden: BTreeSet::new(),
        });
    }
    if let Some(loops) = rim_of.iter().position(Option::is_none) {
        let at = patch.vertices[boundary.loops[loops][0] as usize];
        return Err(Blocked { obstacle: Obstacle::Hole, at });
    }
    Ok(ribbons)
}

/// The triangles of the ribbons, such that none of them meets another or one of `mesh`, whose triangles `tree` holds.
pub(super) fn triangles(
    mesh: &TriMesh,
    tree: &BoxTree,
    ribbons: &mut [Ribbon],
    run: &RunSettings,
) -> Result<Result<Vec<[u32; 3]>, Blocked>, Cancelled> {
    let mut at = [0.0; 3];
    let mut paths: Vec<Vec<Step>> = vec![Vec::new(); ribbons.len()];
    let mut stale: Vec<bool> = vec![true; ribbons.len()];
    for _ in 0..TRIES {
        run.check()?;
        for (n, ribbon) in ribbons.iter().enumerate().filter(|&(n, _)| stale[n]) {
            let Some(path) = ribbon.cheapest() else {
                let at = ribbon.boundary.points[0].to_array();
                return Ok(Err(Blocked { obstacle: Obstacle::Ribbon, at }));
            };
            paths[n] = path;
        }
        // Which ribbon and step each triangle is.
        let steps: Vec<(usize, Step)> =
            paths.iter().enumerate().flat_map(|(n, path)| path.iter().map(move |&s| (n, s))).collect();
        let triangles: Vec<[u32; 3]> = steps.iter().map(|&(n, s)| ribbons[n].triangle(s)).collect();
        let strip = TriMesh { vertices: mesh.vertices.clone(), triangles };
        let mut bad: Vec<(usize, Step)> = strip
            .triangles
            .par_iter()
            .enumerate()
            .with_min_len(16)
            .filter(|&(n, _)| meets_mesh(mesh, tree, &strip, n))
            .map(|(n, _)| steps[n])
            .collect();
        if bad.is_empty() {
            let own = BoxTree::new(&strip, (0..strip.triangles.len() as u32).into_par_iter());
            let pairs = own.pairs(run, Vec::new, |found: &mut Vec<[u32; 2]>, a, b| {
                if meet(&strip, a as usize, &strip, b as usize).is_some() {
                    found.push([a, b]);
                }
            })?;
            // Of two the costlier one has to go.
            bad = pairs
                .into_iter()
                .flatten()
                .map(|pair| {
                    let [a, b] = pair.map(|t| steps[t as usize]);
                    if ribbons[a.0].cost_of(a.1) > ribbons[b.0].cost_of(b.1) { a } else { b }
                })
                .collect();
        }
        if bad.is_empty() {
            return Ok(Ok(strip.triangles));
        }
        stale.fill(false);
        for (n, step) in bad {
            stale[n] = true;
            at = match step {
                Step::Boundary(i, _) | Step::Rim(i, _) => ribbons[n].boundary.points[i as usize].to_array(),
            };
            ribbons[n].forbidden.insert(step);
        }
    }
    Ok(Err(Blocked { obstacle: Obstacle::Ribbon, at }))
}

fn meet(a: &TriMesh, n: usize, b: &TriMesh, m: usize) -> Option<[f64; 3]> {
    meeting_point(a.triangles[n], a.corners(n), b.triangles[m], b.corners(m))
}

/// Whether triangle `n` of `strip` has no area or meets one of `mesh`.
fn meets_mesh(mesh: &TriMesh, tree: &BoxTree, strip: &TriMesh, n: usize) -> bool {
    let corners = strip.corners(n).map(DVec3::from);
    if crate::geom::predicates::projection_axis(strip.corners(n)).is_none() {
        return true;
    }
    let lo = corners[0].min(corners[1]).min(corners[2]);
    let hi = corners[0].max(corners[1]).max(corners[2]);
    let mut found = false;
    tree.near(lo.midpoint(hi), 0.5000001 * (hi - lo).max_element(), |t| {
        found = found || meet(strip, n, mesh, t as usize).is_some();
    });
    found
}
