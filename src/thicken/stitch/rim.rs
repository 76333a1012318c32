//! Rims of section and shell: the boundary loop of S that each runs around.

use super::boundary_curve::{BoundaryCurve, CurvePoint};
use crate::mesh::TriMesh;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Limits of a rim's distance from the boundary, in model units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RimLimits {
    /// Maximum distance of a rim's vertex from the boundary: as far as the section can extend.
    pub max_distance: f64,
    /// Maximum distance along the boundary that a cross edge of a strip may span beyond the
    /// adjacent vertices.
    pub max_slide: f64,
}

/// A rim, projected to a boundary loop.
pub(crate) struct RimProjection {
    /// Positions of the rim's vertices.
    pub points: Vec<DVec3>,
    /// Per vertex of the rim, the closest point of the loop, which is the same for all.
    pub closest: Vec<CurvePoint>,
    /// Numbers of all loops that vertices of the rim are closest to, ascending.
    pub near_loops: Vec<u32>,
    /// Number of times that the rim runs around the loop, against the direction of the section's
    /// triangles; `None` when the rim is not near the loop.
    pub turns: Option<i32>,
}

impl RimProjection {
    /// Returns the number of the loop.
    pub fn loop_number(&self) -> usize {
        self.closest[0].loop_number as usize
    }

    /// Projects a rim to the boundary loop that most of its vertices are near to.
    pub fn new(curve: &BoundaryCurve, mesh: &TriMesh, rim: &[u32], limits: RimLimits) -> RimProjection {
        let points: Vec<DVec3> = rim.iter().map(|&v| DVec3::from(mesh.vertices[v as usize])).collect();
        let mut closest: Vec<_> = points.par_iter().with_min_len(64).map(|&p| curve.closest(p)).collect();
        // Where loops are near to each other or touch, a rim belongs to the loop that most of it is
        // near to.
        let mut counts: BTreeMap<u32, usize> = BTreeMap::new();
        closest.iter().for_each(|c| *counts.entry(c.loop_number).or_default() += 1);
        let number = counts.iter().max_by_key(|(_, count)| **count).map_or(0, |(&number, _)| number);
        for (c, &p) in closest.iter_mut().zip(&points).filter(|(c, _)| c.loop_number != number) {
            *c = curve.closest_of(p, number, None).unwrap_or(*c);
        }
        // A vertex belongs to the part of the loop that the rim has come along.
        let first = (0..rim.len()).min_by(|&a, &b| closest[a].distance.total_cmp(&closest[b].distance));
        let first = first.unwrap_or_default();
        let length = curve.length(number);
        let mut turned = 0.0;
        for j in 1..=rim.len() {
            let (before, at) = ((first + j - 1) % rim.len(), (first + j) % rim.len());
            let most = 2.0 * points[before].distance(points[at]) + 2.0 * limits.max_slide;
            let step = |to: f64| {
                let step = to - closest[before].arc_length;
                step - length * (step / length).round()
            };
            if step(closest[at].arc_length).abs() > most
                && let Some(near) =
                    curve.closest_of(points[at], number, Some((closest[before].arc_length, most)))
                && near.distance <= limits.max_distance
                && j < rim.len()
            {
                closest[at] = near;
            }
            let step = closest[at].arc_length - closest[before].arc_length;
            turned += step - length * (step / length).round();
        }
        let near_loops = counts.into_keys().collect();
        let is_near = closest.iter().all(|c| c.distance <= limits.max_distance);
        let turns = is_near.then_some(-(turned / length).round() as i32);
        RimProjection { points, closest, near_loops, turns }
    }
}

/// The relation of a rim to the boundary loop near it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RimMatch {
    /// The rim runs around the loop once.
    Around,
    /// The rim has so few vertices that nobody can tell, and the loop has no other rim.
    Small,
    /// The rim runs around nothing.
    Stray,
    /// The rim runs around the loop more than once, or another rim does, too.
    Tangled,
}

/// Maximum product of the numbers of vertices of a loop and its rim for which all strips between
/// them are looked at: a millisecond.
const MAX_CROSS_EDGES: usize = 1 << 16;

/// Returns the relation of each rim to its boundary loop.
pub(crate) fn match_rims(rims: &[RimProjection], boundary: &Boundary) -> Vec<RimMatch> {
    let mut is_taken = vec![false; boundary.loops.len()];
    let mut found = vec![RimMatch::Stray; rims.len()];
    for (found, rim) in found.iter_mut().zip(rims) {
        *found = match rim.turns {
            None | Some(0) => RimMatch::Stray,
            Some(1) if !std::mem::replace(&mut is_taken[rim.loop_number()], true) => RimMatch::Around,
            Some(_) => RimMatch::Tangled,
        };
    }
    for (found, rim) in found.iter_mut().zip(rims) {
        let is_small = rim.points.len() * boundary.loops[rim.loop_number()].len() <= MAX_CROSS_EDGES;
        if matches!(rim.turns, Some(0 | -1))
            && is_small
            && !std::mem::replace(&mut is_taken[rim.loop_number()], true)
        {
            *found = RimMatch::Small;
        }
    }
    found
}
