//! Joins the boundary of S to the rims of the section.

use super::boundary_curve::Curve;
use super::open_mesh::{Change, OpenMesh};
use super::rim::{Match, Reach, RimPlace, matches};
use super::small_rims;
use super::strip::{Ribbon, Side};
use super::strip_fitting::{Around, Conflict, Free};
use crate::geom::box_tree::BoxTree;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::thicken::error::{Blocked, Obstacle};
use crate::thicken::patch::boundary::Boundary;
use crate::thicken::patch::intersections;
use crate::thicken::patch::minimal_triangulation::Polygon;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How often the section is cut back where no strip fits: how deep the patch hangs into the solid there is no matter of
/// the lattice.
const CUTS: usize = 32;

/// Rounds of closing holes and islands at most: each can open the way to another one's.
const STRAYS: usize = 12;

/// So often each place has its own number of rings. Where that does not help, conflicts wander, and the same is cut away
/// around all of them.
const APART: usize = 20;

/// Where the section was cut back, and how often. A place that needs many rings must not take them from others.
struct CutPlaces {
    places: Vec<(DVec3, usize)>,
    /// Conflicts within this distance are at the same place, in model units.
    near: f64,
}

impl CutPlaces {
    /// The rings of triangles to cut away around each conflict: one more with every second time.
    fn again(&mut self, conflicts: &[Conflict]) -> Vec<usize> {
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

/// Rims that run around no boundary loop are those of holes and islands where the lattice is too coarse for what is there: both
/// are undone.
fn close_strays(patch: &TriMesh, boundary: &Boundary, open: &mut OpenMesh, reach: Reach, change: Change) {
    let curve = (!boundary.is_empty()).then(|| Curve::new(patch, boundary));
    for _ in 0..STRAYS {
        let rims = open.rims();
        let is_stray: Vec<bool> = match &curve {
            None => vec![true; rims.len()],
            Some(curve) => {
                let places = rims.iter().map(|rim| RimPlace::new(curve, &open.mesh, rim, reach));
                let matches = matches(&places.collect::<Vec<_>>(), boundary);
                matches.into_iter().map(|found| found == Match::Stray).collect()
            }
        };
        if !is_stray.contains(&true) || !open.close(&rims, |n| is_stray[n], change) {
            break;
        }
    }
}

/// What is to be closed.
#[derive(Debug, Default)]
struct Gaps {
    /// Between a boundary loop and its rim.
    ribbons: Vec<Ribbon>,
    /// Small rims around nothing.
    lids: Vec<Polygon>,
}

/// The gaps at all rims and boundary loops. Vertices of the rims are numbered on from `first`.
///
/// # Errors
/// The first rim or loop without a counterpart, with all loops that are near such ones.
fn gaps(
    patch: &TriMesh,
    boundary: &Boundary,
    open: &OpenMesh,
    first: u32,
    reach: Reach,
) -> Result<Gaps, Blocked> {
    let rims = open.rims();
    let curve = (!boundary.is_empty()).then(|| Curve::new(patch, boundary));
    let place = |rim: &Vec<u32>| curve.as_ref().map(|curve| RimPlace::new(curve, &open.mesh, rim, reach));
    let places: Vec<RimPlace> = rims.iter().filter_map(place).collect();
    let matches = if curve.is_some() { matches(&places, boundary) } else { vec![Match::Stray; rims.len()] };
    let mut has_rim = vec![false; boundary.loops.len()];
    let mut obstacles = Vec::new();
    let mut in_the_way = BTreeSet::new();
    let mut gaps = Gaps::default();
    for (n, (rim, &found)) in rims.iter().zip(&matches).enumerate() {
        let obstacle = match found {
            Match::Around | Match::Small => {
                has_rim[places[n].number()] = true;
                continue;
            }
            Match::Stray if rim.len() <= small_rims::MOST => {
                gaps.lids.push(lid(open, rim, first));
                continue;
            }
            Match::Stray => Obstacle::Sheets,
            Match::Tangled => Obstacle::Loops,
        };
        obstacles.push((obstacle, open.mesh.vertices[rim[0] as usize]));
        in_the_way.extend(places.get(n).iter().flat_map(|place| &place.near).map(|&n| n as usize));
    }
    for (number, around) in boundary.loops.iter().enumerate().filter(|&(n, _)| !has_rim[n]) {
        obstacles.push((Obstacle::Hole, patch.vertices[around[0] as usize]));
        in_the_way.insert(number);
    }
    if let Some(&(obstacle, at)) = obstacles.first() {
        let edges = in_the_way.iter().map(|&n| [boundary.loops[n][0], boundary.loops[n][1]]).collect();
        return Err(Blocked { obstacle, at, edges });
    }
    if let Some(curve) = &curve {
        for ((rim, place), &found) in rims.iter().zip(&places).zip(&matches) {
            if found != Match::Stray {
                gaps.ribbons.push(ribbon(curve, patch, rim, place, found, first, reach));
            }
        }
    }
    Ok(gaps)
}

/// The polygon over a rim.
fn lid(open: &OpenMesh, rim: &[u32], first: u32) -> Polygon {
    // Against the direction of the triangles beside it.
    let around = rim.iter().rev();
    Polygon {
        vertices: around.clone().map(|&v| first + v).collect(),
        points: around.map(|&v| DVec3::from(open.mesh.vertices[v as usize])).collect(),
        forbidden: BTreeSet::new(),
    }
}

/// The strip between a rim and its loop.
fn ribbon(
    curve: &Curve,
    patch: &TriMesh,
    rim: &[u32],
    place: &RimPlace,
    found: Match,
    first: u32,
    reach: Reach,
) -> Ribbon {
    let RimPlace { points, closest, .. } = place;
    // Against the direction of the section's triangles.
    let count = rim.len();
    let start =
        (0..count).min_by(|&a, &b| closest[a].distance.total_cmp(&closest[b].distance)).unwrap_or_default();
    let order: Vec<usize> = (0..=count).map(|j| (start + count - j % count) % count).collect();
    let number = place.number() as u32;
    let (arcs, around) = (curve.arcs(number), curve.vertices(number));
    let (length, whole) = (around.len(), curve.whole(number));
    // The boundary begins with the vertex before the first rim vertex's closest point.
    let begin = arcs.partition_point(|&arc| arc <= closest[start].arc).clamp(1, length) - 1;
    let vertices: Vec<u32> = (0..=length).map(|i| around[(begin + i) % length]).collect();
    let arc_at = |i: usize| {
        let turns = if begin + i >= length { whole } else { 0.0 };
        arcs[(begin + i) % length] - arcs[begin] + turns
    };
    let boundary = Side {
        points: vertices.iter().map(|&v| DVec3::from(patch.vertices[v as usize])).collect(),
        vertices,
        arcs: (0..=length).map(arc_at).collect(),
    };
    let mut arc = closest[start].arc - arcs[begin];
    let mut rim_arcs = vec![arc];
    for pair in order.windows(2) {
        let step = closest[pair[1]].arc - closest[pair[0]].arc;
        arc += step - whole * (step / whole).round();
        rim_arcs.push(arc);
    }
    if found == Match::Small {
        rim_arcs = (0..=count).map(|j| whole * j as f64 / count as f64).collect();
    }
    let rim = Side {
        vertices: order.iter().map(|&j| first + rim[j]).collect(),
        points: order.iter().map(|&j| points[j]).collect(),
        arcs: rim_arcs,
    };
    let reach = if found == Match::Small { whole } else { reach.along };
    Ribbon { boundary, rim, reach, forbidden: BTreeSet::new() }
}

/// A closed mesh.
#[derive(Debug)]
pub(crate) struct Stitched {
    /// The triangles of the patch, of the contour, of what joins them.
    pub mesh: TriMesh,
    /// The lattice edge of each triangle of the contour.
    pub edges: Vec<u32>,
}

/// The patch, the section and the ribbons between them, if they can be joined without intersections.
pub(crate) fn stitch(
    patch: &TriMesh,
    boundary: &Boundary,
    mut open: OpenMesh,
    reach: Reach,
    run: &RunSettings,
) -> Result<Result<Stitched, Blocked>, Cancelled> {
    close_strays(patch, boundary, &mut open, reach, Change::Both);
    let first = patch.vertices.len() as u32;
    let mut mesh = patch.clone();
    mesh.vertices.extend(&open.mesh.vertices);
    mesh.triangles.extend(open.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    let patch_count = patch.triangles.len();
    let with_section: Vec<u32> = (0..mesh.triangles.len())
        .filter(|&t| t < patch_count || open.kept[t - patch_count])
        .map(|t| t as u32)
        .collect();
    let tree = BoxTree::new(&mesh.vertices, &mesh.triangles, with_section.into_par_iter());
    // What meets the patch near a rim goes; the ribbon takes its place.
    let meeting = intersections::meeting_patch(&mesh, &tree, patch_count as u32, run)?;
    if !meeting.is_empty() {
        open.drop_around(meeting.keys().map(|&t| t as usize - patch_count), 1);
        close_strays(patch, boundary, &mut open, reach, Change::Drop);
    }
    let mut cuts = 0;
    // From here on, triangles are only left out.
    let mut free = Free::default();
    let mut cut_places = CutPlaces { places: Vec::new(), near: reach.along };
    let strip = loop {
        let Gaps { mut ribbons, lids } = match gaps(patch, boundary, &open, first, reach) {
            Ok(gaps) => gaps,
            Err(blocked) => return Ok(Err(blocked)),
        };
        let around = Around { mesh: &mesh, tree: &tree, patch: patch_count, kept: &open.kept };
        let fit = match around.fit(&mut ribbons, &mut free, run)? {
            Ok(strip) => around.fit_lids(&lids, strip, run)?,
            Err(conflicts) => Err(conflicts),
        };
        match fit {
            Ok(strip) => break strip,
            Err(conflicts) if cuts == CUTS || conflicts.is_empty() => {
                let at = conflicts.first().map_or(patch.vertices[0], |c| c.at);
                let stuck: BTreeSet<usize> = conflicts.iter().filter_map(|c| c.ribbon).collect();
                let start = |n: &usize| [0, 1].map(|k| ribbons[*n].boundary.vertices[k]);
                let edges = stuck.iter().map(start).collect();
                return Ok(Err(Blocked { obstacle: Obstacle::Ribbon, at, edges }));
            }
            Err(conflicts) => {
                let rings = cut_places.again(&conflicts);
                let least = cuts.saturating_sub(APART) / 2;
                // By the number of rings, so that each goes with its own.
                let mut dropped: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
                for (conflict, rings) in conflicts.into_iter().zip(rings) {
                    let dropped = dropped.entry(rings.max(least)).or_default();
                    dropped.extend(conflict.section);
                    for v in conflict.rim {
                        let star = open.topology.around_vertex(v - first);
                        dropped.extend(star.iter().map(|&t| t as usize));
                    }
                }
                for (rings, triangles) in dropped {
                    open.drop_around(triangles, rings);
                }
                close_strays(patch, boundary, &mut open, reach, Change::Drop);
                cuts += 1;
            }
        }
    };
    let mut number = 0;
    mesh.triangles.retain(|_| {
        number += 1;
        number <= patch_count || open.kept[number - 1 - patch_count]
    });
    mesh.triangles.extend(strip);
    mesh.drop_unreferenced_vertices(first as usize);
    let kept = open.edges.iter().zip(&open.kept).filter(|&(_, &kept)| kept);
    let edges = kept.map(|(&edge, _)| edge).collect();
    Ok(Ok(Stitched { mesh, edges }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_grow_where_cuts_do_not_help_and_nowhere_else() {
        let conflict = |x: f64| Conflict { rim: vec![], section: vec![], at: [x, 0.0, 0.0], ribbon: None };
        let mut cuts = CutPlaces { places: Vec::new(), near: 1.0 };
        assert_eq!(cuts.again(&[conflict(0.0), conflict(0.5)]), [0, 0]);
        assert_eq!(cuts.again(&[conflict(0.4), conflict(9.0)]), [0, 0]);
        assert_eq!(cuts.again(&[conflict(-0.2), conflict(9.3), conflict(5.0)]), [1, 0, 0]);
        assert_eq!(cuts.again(&[conflict(0.1), conflict(9.1)]), [1, 1]);
    }
}
