//! Joins the boundary of S to the rims of the section.

use super::boundary::Boundary;
use super::curve::{Curve, CurvePoint};
use super::open_mesh::{Change, OpenMesh};
use super::ribbon::{Ribbon, Side, Step};
use super::unsuitable::{Blocked, Obstacle};
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::verify::boxes::BoxTree;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How a rim may lie to the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// A rim's vertex is at most this far from the boundary, in model units: as far as the section reaches.
    pub across: f64,
    /// A rung leads at most this far along the boundary beyond the next vertices.
    pub along: f64,
}

/// Strips are chosen anew this often without the triangles that meet something. Each time most conflicts are gone; what
/// is left after so many goes round in circles.
const TRIES: usize = 12;

/// How often the section is cut back where no strip fits, by one ring of triangles at first and more each time: how deep
/// the patch hangs into the solid there is no matter of the lattice.
const CUTS: usize = 12;

/// A rim, seen from the boundary.
struct RimPlace {
    points: Vec<DVec3>,
    /// Per vertex the closest point of one and the same loop.
    closest: Vec<CurvePoint>,
    /// How often the rim runs around that loop, against the direction of the section's triangles; `None` when it is
    /// not near it.
    turns: Option<i32>,
}

impl RimPlace {
    fn new(curve: &Curve, mesh: &TriMesh, rim: &[u32], reach: Reach) -> RimPlace {
        let points: Vec<DVec3> = rim.iter().map(|&v| DVec3::from(mesh.vertices[v as usize])).collect();
        let mut closest: Vec<_> = points.par_iter().with_min_len(64).map(|&p| curve.closest(p)).collect();
        // Where loops are near to each other or touch, a rim belongs to the one that most of it is near to.
        let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
        closest.iter().for_each(|c| *counts.entry(c.number).or_default() += 1);
        let number = counts.iter().max_by_key(|(_, count)| **count).map_or(0, |(&number, _)| number);
        for (c, &p) in closest.iter_mut().zip(&points).filter(|(c, _)| c.number != number) {
            *c = curve.closest_of(p, number, None).unwrap_or(*c);
        }
        // And to the part of the loop that it has come along.
        let first = (0..rim.len()).min_by(|&a, &b| closest[a].distance.total_cmp(&closest[b].distance));
        let first = first.unwrap_or_default();
        let whole = curve.whole(number);
        let mut turned = 0.0;
        for j in 1..=rim.len() {
            let (before, at) = ((first + j - 1) % rim.len(), (first + j) % rim.len());
            let most = 2.0 * points[before].distance(points[at]) + 2.0 * reach.along;
            let step = |arc: f64| {
                let step = arc - closest[before].arc;
                step - whole * (step / whole).round()
            };
            if step(closest[at].arc).abs() > most
                && let Some(near) = curve.closest_of(points[at], number, Some((closest[before].arc, most)))
                && near.distance <= reach.across
                && j < rim.len()
            {
                closest[at] = near;
            }
            let step = closest[at].arc - closest[before].arc;
            turned += step - whole * (step / whole).round();
        }
        let is_near = closest.iter().all(|c| c.distance <= reach.across);
        let turns = is_near.then_some(-(turned / whole).round() as i32);
        RimPlace { points, closest, turns }
    }
}

/// Rims that run around no boundary loop are those of holes and islands where the lattice is too coarse for what is there: both
/// are undone.
fn close_strays(patch: &TriMesh, boundary: &Boundary, open: &mut OpenMesh, reach: Reach, change: Change) {
    let curve = (!boundary.is_empty()).then(|| Curve::new(patch, boundary));
    for _ in 0..CUTS {
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

/// What a rim is to the loop near it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Match {
    /// It runs around it once.
    Around,
    /// So few vertices that nobody can tell, and no other rim is there for the loop.
    Small,
    /// It runs around nothing.
    Stray,
    /// It runs around it more than once, or another one does, too.
    Tangled,
}

/// Vertices of a loop and of its rim, multiplied, up to which all strips between them are looked at.
const SMALL: usize = 4096;

fn matches(places: &[RimPlace], boundary: &Boundary) -> Vec<Match> {
    let mut is_taken = vec![false; boundary.loops.len()];
    let number = |place: &RimPlace| place.closest[0].number as usize;
    let mut found = vec![Match::Stray; places.len()];
    for (found, place) in found.iter_mut().zip(places) {
        *found = match place.turns {
            None | Some(0) => Match::Stray,
            Some(1) if !std::mem::replace(&mut is_taken[number(place)], true) => Match::Around,
            Some(_) => Match::Tangled,
        };
    }
    for (found, place) in found.iter_mut().zip(places) {
        let is_small = place.points.len() * boundary.loops[number(place)].len() <= SMALL;
        if matches!(place.turns, Some(0 | -1))
            && is_small
            && !std::mem::replace(&mut is_taken[number(place)], true)
        {
            *found = Match::Small;
        }
    }
    found
}

/// Pairs each rim with a boundary loop. Vertices of the rims are numbered on from `first`.
fn ribbons(
    patch: &TriMesh,
    boundary: &Boundary,
    open: &OpenMesh,
    first: u32,
    reach: Reach,
) -> Result<Vec<Ribbon>, Blocked> {
    let rims = open.rims();
    if boundary.is_empty() {
        let stray = rims.first().map(|rim| open.mesh.vertices[rim[0] as usize]);
        return stray.map_or(Ok(Vec::new()), |at| Err(Blocked { obstacle: Obstacle::Sheets, at }));
    }
    let curve = Curve::new(patch, boundary);
    let mut rim_of: Vec<Option<usize>> = vec![None; boundary.loops.len()];
    let mut ribbons = Vec::with_capacity(rims.len());
    let places: Vec<RimPlace> =
        rims.iter().map(|rim| RimPlace::new(&curve, &open.mesh, rim, reach)).collect();
    let matches = matches(&places, boundary);
    for ((number, rim), (place, found)) in rims.iter().enumerate().zip(places.into_iter().zip(matches)) {
        let RimPlace { points, closest, .. } = place;
        let at = points[0].to_array();
        match found {
            Match::Around | Match::Small => {}
            Match::Stray => return Err(Blocked { obstacle: Obstacle::Sheets, at }),
            Match::Tangled => return Err(Blocked { obstacle: Obstacle::Loops, at }),
        }
        let loops = closest[0].number as usize;
        rim_of[loops] = Some(number);
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
        if found == Match::Small {
            for (j, arc) in rim_arcs.iter_mut().enumerate() {
                *arc = whole * j as f64 / count as f64;
            }
        }
        let rim_side = Side {
            vertices: order.iter().map(|&j| first + rim[j]).collect(),
            points: order.iter().map(|&j| points[j]).collect(),
            arcs: rim_arcs,
        };
        ribbons.push(Ribbon {
            boundary: boundary_side,
            rim: rim_side,
            reach: if found == Match::Small { whole } else { reach.along },
            forbidden: BTreeSet::new(),
        });
    }
    if let Some(loops) = rim_of.iter().position(Option::is_none) {
        let at = patch.vertices[boundary.loops[loops][0] as usize];
        return Err(Blocked { obstacle: Obstacle::Hole, at });
    }
    Ok(ribbons)
}

/// The patch, the section and the ribbons between them, if they can be joined without intersections.
pub(super) fn stitch(
    patch: &TriMesh,
    boundary: &Boundary,
    mut open: OpenMesh,
    reach: Reach,
    run: &RunSettings,
) -> Result<Result<TriMesh, Blocked>, Cancelled> {
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
    let tree = BoxTree::new(&mesh, with_section.into_par_iter());
    // What meets the patch near a rim goes; the ribbon takes its place.
    let meeting = super::check::meeting_patch(&mesh, &tree, patch_count as u32, run)?;
    if !meeting.is_empty() {
        open.drop_around(meeting.keys().map(|&t| t as usize - patch_count), 1);
        close_strays(patch, boundary, &mut open, reach, Change::Drop);
    }
    let mut cuts = 0;
    let strip = loop {
        let mut ribbons = match ribbons(patch, boundary, &open, first, reach) {
            Ok(ribbons) => ribbons,
            Err(blocked) => return Ok(Err(blocked)),
        };
        let around = Around { mesh: &mesh, tree: &tree, patch: patch_count, kept: &open.kept };
        match around.fit(&mut ribbons, run)? {
            Ok(strip) => break strip,
            Err(conflicts) if cuts == CUTS || conflicts.is_empty() => {
                let at =
                    conflicts.first().map_or_else(|| patch.vertices[boundary.loops[0][0] as usize], |c| c.at);
                return Ok(Err(Blocked { obstacle: Obstacle::Ribbon, at }));
            }
            Err(conflicts) => {
                let mut dropped: Vec<usize> = Vec::new();
                for conflict in conflicts {
                    dropped.extend(conflict.section);
                    for v in conflict.rim {
                        let star = open.topology.around_vertex(v - first);
                        dropped.extend(star.iter().map(|&t| t as usize));
                    }
                }
                open.drop_around(dropped, cuts / 2);
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
    super::open_mesh::without_idle_vertices(&mut mesh, first as usize);
    Ok(Ok(mesh))
}

/// A step of a ribbon that does not fit.
#[derive(Debug)]
struct Conflict {
    /// Rim vertices at it.
    rim: Vec<u32>,
    /// The section's triangles that it meets.
    section: Vec<usize>,
    at: [f64; 3],
}

/// What ribbons must not meet.
struct Around<'a> {
    mesh: &'a TriMesh,
    tree: &'a BoxTree,
    /// The first triangles are those of the patch.
    patch: usize,
    /// Whether each of the others is there.
    kept: &'a [bool],
}

impl Around<'_> {
    /// The triangles of ribbons that meet nothing, or where they would.
    fn fit(
        &self,
        ribbons: &mut [Ribbon],
        run: &RunSettings,
    ) -> Result<Result<Vec<[u32; 3]>, Vec<Conflict>>, Cancelled> {
        let mut paths: Vec<Vec<Step>> = vec![Vec::new(); ribbons.len()];
        let mut stale: Vec<bool> = vec![true; ribbons.len()];
        let mut bad: Vec<(usize, Step)> = Vec::new();
        for tries in 0.. {
            run.check()?;
            let mut stuck = false;
            for (n, ribbon) in ribbons.iter().enumerate().filter(|&(n, _)| stale[n]) {
                match ribbon.cheapest() {
                    Some(path) => paths[n] = path,
                    None => stuck = true,
                }
            }
            if stuck || tries == TRIES {
                if bad.is_empty() {
                    // Not even without conflicts: the ends are out of reach of each other.
                    bad.extend(ribbons.iter().enumerate().map(|(n, _)| (n, Step::Rim(0, 0))));
                }
                let conflicts = bad.iter().map(|&(n, step)| self.conflict(&ribbons[n], step)).collect();
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
                .filter(|&(_, &t)| self.meets(t))
                .map(|(&step, _)| step)
                .collect();
            if bad.is_empty() {
                let strip = TriMesh { vertices: self.mesh.vertices.clone(), triangles };
                bad = costlier_of_pairs(&strip, &steps, ribbons, run)?;
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
    fn meeting(&self, t: [u32; 3], mut visit: impl FnMut(usize)) {
        let corners = t.map(|v| self.mesh.vertices[v as usize]);
        let [a, b, c] = corners.map(DVec3::from);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        // Half the longest side, and a little for rounding.
        self.tree.near(lo.midpoint(hi), 0.500_001 * (hi - lo).max_element(), |n| {
            let n = n as usize;
            let is_there = n < self.patch || self.kept[n - self.patch];
            if is_there && meeting_point(t, corners, self.mesh.triangles[n], self.mesh.corners(n)).is_some() {
                visit(n);
            }
        });
    }

    /// Whether triangle `t` of the strip has no area or meets what is there.
    fn meets(&self, t: [u32; 3]) -> bool {
        if projection_axis(t.map(|v| self.mesh.vertices[v as usize])).is_none() {
            return true;
        }
        let mut found = false;
        self.meeting(t, |_| found = true);
        found
    }

    fn conflict(&self, ribbon: &Ribbon, step: Step) -> Conflict {
        let triangle = ribbon.triangle(step);
        let mut section = Vec::new();
        self.meeting(triangle, |n| section.extend(n.checked_sub(self.patch)));
        let (Step::Boundary(_, j) | Step::Rim(_, j)) = step;
        let rim = match step {
            Step::Boundary(..) => vec![ribbon.rim.vertices[j as usize]],
            Step::Rim(..) => ribbon.rim.vertices[j as usize..=j as usize + 1].to_vec(),
        };
        Conflict { rim, section, at: self.mesh.vertices[triangle[2] as usize] }
    }
}

/// Of each two triangles of the strip that meet the costlier one.
fn costlier_of_pairs(
    strip: &TriMesh,
    steps: &[(usize, Step)],
    ribbons: &[Ribbon],
    run: &RunSettings,
) -> Result<Vec<(usize, Step)>, Cancelled> {
    let own = BoxTree::new(strip, (0..strip.triangles.len() as u32).into_par_iter());
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
