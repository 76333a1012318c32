//! The joining of boundary loops of S to rims of the section, by strips and caps.

use super::boundary_curve::BoundaryCurve;
use super::open_mesh::{Change, OpenMesh};
use super::rim::{RimLimits, RimMatch, RimProjection, match_rims};
use super::small_rims;
use super::strip::{Polyline, Strip};
use super::strip_fitting::{ClearTriangles, Conflict, Fit, Surroundings};
use crate::geom::box_tree::BoxTree;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::thicken::Obstacle;
use crate::thicken::outcome::{Blockage, Outcome};
use crate::thicken::patch::boundary::Boundary;
use crate::thicken::patch::intersections;
use crate::thicken::patch::minimal_triangulation::Polygon;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of times that the section is trimmed where no strip fits. The depth to which the
/// patch hangs into the solid there has nothing to do with the lattice.
const MAX_TRIMS: usize = 32;

/// Maximum number of rounds of removing stray rims: each can uncover another stray.
const MAX_STRAY_ROUNDS: usize = 12;

/// Number of trims in which each place has a number of rings of its own. Where that does not help,
/// conflicts wander, and the same number of rings is trimmed around all of them.
const LOCAL_TRIMS: usize = 20;

/// The places at which the section was trimmed, with the number of times. A place that needs many
/// rings must not take them from others.
struct TrimHistory {
    places: Vec<(DVec3, usize)>,
    /// Maximum distance of conflicts at the same place, in model units.
    near: f64,
}

impl TrimHistory {
    /// Returns the number of rings of triangles to trim around each conflict: one more with every
    /// second time at a place.
    fn next_rings(&mut self, conflicts: &[Conflict]) -> Vec<usize> {
        let times = |conflict: &Conflict| {
            let at = DVec3::from(conflict.at);
            let near = self.places.iter().filter(|(place, _)| place.distance(at) <= self.near);
            (at, near.map(|&(_, times)| times).max().unwrap_or(0))
        };
        let all: Vec<(DVec3, usize)> = conflicts.iter().map(times).collect();
        self.places.extend(all.iter().map(|&(at, times)| (at, times + 1)));
        all.into_iter().map(|(_, times)| times / 2).collect()
    }
}

/// Removes the rims that run around no boundary loop. Such rims bound holes and islands, which a
/// lattice makes where it is too coarse for the surface.
fn remove_strays(
    patch: &TriMesh,
    boundary: &Boundary,
    open: &mut OpenMesh,
    limits: RimLimits,
    change: Change,
) {
    let curve = (!boundary.is_empty()).then(|| BoundaryCurve::new(patch, boundary));
    for _ in 0..MAX_STRAY_ROUNDS {
        let rims = open.rims();
        let is_stray: Vec<bool> = match &curve {
            None => vec![true; rims.len()],
            Some(curve) => {
                let projections = rims.iter().map(|rim| RimProjection::new(curve, &open.mesh, rim, limits));
                let matches = match_rims(&projections.collect::<Vec<_>>(), boundary);
                matches.into_iter().map(|found| found == RimMatch::Stray).collect()
            }
        };
        if !is_stray.contains(&true) || !open.remove_strays(&rims, |n| is_stray[n], change) {
            break;
        }
    }
}

/// The gaps between patch and contour.
#[derive(Debug, Default)]
struct Gaps {
    /// Strips between a boundary loop and its rim.
    strips: Vec<Strip>,
    /// Small rims around nothing.
    small_rims: Vec<Polygon>,
}

/// Finds the gaps at all rims and boundary loops. Vertices of the rims are numbered on from
/// `first`.
///
/// Blocked by a rim or a loop without a counterpart; the blockage has all loops that are near such
/// ones.
fn gaps(
    patch: &TriMesh,
    boundary: &Boundary,
    open: &OpenMesh,
    first: u32,
    limits: RimLimits,
) -> Outcome<Gaps> {
    let rims = open.rims();
    let curve = (!boundary.is_empty()).then(|| BoundaryCurve::new(patch, boundary));
    let project =
        |rim: &Vec<u32>| curve.as_ref().map(|curve| RimProjection::new(curve, &open.mesh, rim, limits));
    let projections: Vec<RimProjection> = rims.iter().filter_map(project).collect();
    let matches = match &curve {
        Some(_) => match_rims(&projections, boundary),
        None => vec![RimMatch::Stray; rims.len()],
    };
    let mut has_rim = vec![false; boundary.loops.len()];
    let mut obstacles = Vec::new();
    let mut in_the_way = BTreeSet::new();
    let mut gaps = Gaps::default();
    for (n, (rim, &found)) in rims.iter().zip(&matches).enumerate() {
        let obstacle = match found {
            RimMatch::Around | RimMatch::Small => {
                has_rim[projections[n].loop_number()] = true;
                continue;
            }
            RimMatch::Stray if rim.len() <= small_rims::MAX_RIM_VERTICES => {
                gaps.small_rims.push(polygon_over(open, rim, first));
                continue;
            }
            RimMatch::Stray => Obstacle::Sheets,
            RimMatch::Tangled => Obstacle::Loops,
        };
        obstacles.push((obstacle, open.mesh.vertices[rim[0] as usize]));
        let near = projections.get(n).into_iter().flat_map(|rim| &rim.near_loops);
        in_the_way.extend(near.map(|&n| n as usize));
    }
    for (number, around) in boundary.loops.iter().enumerate().filter(|&(n, _)| !has_rim[n]) {
        obstacles.push((Obstacle::Hole, patch.vertices[around[0] as usize]));
        in_the_way.insert(number);
    }
    if let Some(&(obstacle, at)) = obstacles.first() {
        let edges = in_the_way.iter().map(|&n| [boundary.loops[n][0], boundary.loops[n][1]]).collect();
        return Outcome::Blocked(Blockage { obstacle, at, edges });
    }
    if let Some(curve) = &curve {
        for ((rim, projection), &found) in rims.iter().zip(&projections).zip(&matches) {
            if found != RimMatch::Stray {
                let max_slide = if found == RimMatch::Small { None } else { Some(limits.max_slide) };
                gaps.strips.push(strip(curve, patch, rim, projection, first, max_slide));
            }
        }
    }
    Outcome::Done(gaps)
}

/// Returns the polygon over a rim.
fn polygon_over(open: &OpenMesh, rim: &[u32], first: u32) -> Polygon {
    // Against the direction of the triangles at the rim.
    let around = rim.iter().rev();
    Polygon {
        vertices: around.clone().map(|&v| first + v).collect(),
        points: around.map(|&v| DVec3::from(open.mesh.vertices[v as usize])).collect(),
        forbidden: BTreeSet::new(),
    }
}

/// Returns the strip between a rim and its loop. Without `max_slide`, cross edges may lead from
/// each vertex of the rim to each vertex of the loop.
fn strip(
    curve: &BoundaryCurve,
    patch: &TriMesh,
    rim: &[u32],
    projection: &RimProjection,
    first: u32,
    max_slide: Option<f64>,
) -> Strip {
    let RimProjection { points, closest, .. } = projection;
    // Against the direction of the section's triangles.
    let count = rim.len();
    let start =
        (0..count).min_by(|&a, &b| closest[a].distance.total_cmp(&closest[b].distance)).unwrap_or_default();
    let order: Vec<usize> = (0..=count).map(|j| (start + count - j % count) % count).collect();
    let number = projection.loop_number() as u32;
    let (arcs, around) = (curve.arc_lengths(number), curve.vertices(number));
    let (count_around, length) = (around.len(), curve.length(number));
    // The boundary begins with the vertex before the first rim vertex's closest point.
    let begin = arcs.partition_point(|&arc| arc <= closest[start].arc_length).clamp(1, count_around) - 1;
    let vertices: Vec<u32> = (0..=count_around).map(|i| around[(begin + i) % count_around]).collect();
    let arc_at = |i: usize| {
        let turns = if begin + i >= count_around { length } else { 0.0 };
        arcs[(begin + i) % count_around] - arcs[begin] + turns
    };
    let boundary = Polyline {
        points: vertices.iter().map(|&v| DVec3::from(patch.vertices[v as usize])).collect(),
        vertices,
        arc_lengths: (0..=count_around).map(arc_at).collect(),
    };
    let mut arc = closest[start].arc_length - arcs[begin];
    let mut rim_arcs = vec![arc];
    for pair in order.windows(2) {
        let step = closest[pair[1]].arc_length - closest[pair[0]].arc_length;
        arc += step - length * (step / length).round();
        rim_arcs.push(arc);
    }
    if max_slide.is_none() {
        rim_arcs = (0..=count).map(|j| length * j as f64 / count as f64).collect();
    }
    let rim = Polyline {
        vertices: order.iter().map(|&j| first + rim[j]).collect(),
        points: order.iter().map(|&j| points[j]).collect(),
        arc_lengths: rim_arcs,
    };
    Strip { boundary, rim, max_slide: max_slide.unwrap_or(length), forbidden: BTreeSet::new() }
}

/// The closed boundary of the solid.
#[derive(Debug)]
pub(crate) struct ClosedMesh {
    /// The triangles of the patch, then of the contour, then of strips and caps.
    pub mesh: TriMesh,
    /// Number of the lattice edge of each triangle of the contour.
    pub edges: Vec<u32>,
}

/// Joins the patch and the contour by strips, if that goes without intersections.
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn join(
    patch: &TriMesh,
    boundary: &Boundary,
    mut open: OpenMesh,
    limits: RimLimits,
    run: &RunSettings,
) -> Result<Outcome<ClosedMesh>, Cancelled> {
    remove_strays(patch, boundary, &mut open, limits, Change::KeepOrDrop);
    let first = patch.vertices.len() as u32;
    let mut mesh = patch.clone();
    mesh.vertices.extend(&open.mesh.vertices);
    mesh.triangles.extend(open.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    let patch_count = patch.triangles.len();
    let with_contour: Vec<u32> = (0..mesh.triangles.len())
        .filter(|&t| t < patch_count || open.kept[t - patch_count])
        .map(|t| t as u32)
        .collect();
    let tree = BoxTree::new(&mesh.vertices, &mesh.triangles, with_contour.into_par_iter());
    // Triangles that meet the patch near a rim are left out; the strip takes their place.
    let meeting = intersections::meeting_patch(&mesh, &tree, patch_count as u32, run)?;
    if !meeting.is_empty() {
        open.drop_around(meeting.keys().map(|&t| t as usize - patch_count), 1);
        remove_strays(patch, boundary, &mut open, limits, Change::Drop);
    }
    let mut trims = 0;
    // From here on, triangles are only left out.
    let mut clear = ClearTriangles::default();
    let mut history = TrimHistory { places: Vec::new(), near: limits.max_slide };
    let joining = loop {
        let Gaps { mut strips, small_rims } = match gaps(patch, boundary, &open, first, limits) {
            Outcome::Done(gaps) => gaps,
            Outcome::Blocked(blockage) => return Ok(Outcome::Blocked(blockage)),
        };
        let around = Surroundings { mesh: &mesh, tree: &tree, patch: patch_count, kept: &open.kept };
        let fit = match around.fit_strips(&mut strips, &mut clear, run)? {
            Fit::Triangles(triangles) => around.fit_caps(&small_rims, triangles, run)?,
            conflicts => conflicts,
        };
        match fit {
            Fit::Triangles(triangles) => break triangles,
            Fit::Conflicts(conflicts) if trims == MAX_TRIMS || conflicts.is_empty() => {
                let at = conflicts.first().map_or(patch.vertices[0], |c| c.at);
                let stuck: BTreeSet<usize> = conflicts.iter().filter_map(|c| c.strip).collect();
                let start = |n: &usize| [0, 1].map(|k| strips[*n].boundary.vertices[k]);
                let edges = stuck.iter().map(start).collect();
                return Ok(Outcome::Blocked(Blockage { obstacle: Obstacle::Strip, at, edges }));
            }
            Fit::Conflicts(conflicts) => {
                let rings = history.next_rings(&conflicts);
                let least = trims.saturating_sub(LOCAL_TRIMS) / 2;
                // Triangles by their number of rings.
                let mut dropped: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
                for (conflict, rings) in conflicts.into_iter().zip(rings) {
                    let dropped = dropped.entry(rings.max(least)).or_default();
                    dropped.extend(conflict.contour);
                    for v in conflict.rim {
                        let star = open.topology.around_vertex(v - first);
                        dropped.extend(star.iter().map(|&t| t as usize));
                    }
                }
                for (rings, triangles) in dropped {
                    open.drop_around(triangles, rings);
                }
                remove_strays(patch, boundary, &mut open, limits, Change::Drop);
                trims += 1;
            }
        }
    };
    let mut number = 0;
    mesh.triangles.retain(|_| {
        number += 1;
        number <= patch_count || open.kept[number - 1 - patch_count]
    });
    mesh.triangles.extend(joining);
    mesh.drop_unreferenced_vertices(first as usize);
    let kept = open.edges.iter().zip(&open.kept).filter(|&(_, &kept)| kept);
    let edges = kept.map(|(&edge, _)| edge).collect();
    Ok(Outcome::Done(ClosedMesh { mesh, edges }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_grow_where_trims_do_not_help_and_nowhere_else() {
        let conflict = |x: f64| Conflict { rim: vec![], contour: vec![], at: [x, 0.0, 0.0], strip: None };
        let mut history = TrimHistory { places: Vec::new(), near: 1.0 };
        assert_eq!(history.next_rings(&[conflict(0.0), conflict(0.5)]), [0, 0]);
        assert_eq!(history.next_rings(&[conflict(0.4), conflict(9.0)]), [0, 0]);
        assert_eq!(history.next_rings(&[conflict(-0.2), conflict(9.3), conflict(5.0)]), [1, 0, 0]);
        assert_eq!(history.next_rings(&[conflict(0.1), conflict(9.1)]), [1, 1]);
    }
}
