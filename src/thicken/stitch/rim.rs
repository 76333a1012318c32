//! Which boundary loop of S a rim of the section runs around.

use super::boundary_curve::{Curve, CurvePoint};
use crate::mesh::TriMesh;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// How a rim may lie to the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// A rim's vertex is at most this far from the boundary, in model units: as far as the section reaches.
    pub across: f64,
    /// A rung leads at most this far along the boundary beyond the next vertices.
    pub along: f64,
}

/// A rim, seen from the boundary.
pub(crate) struct RimPlace {
    pub points: Vec<DVec3>,
    /// Per vertex the closest point of one and the same loop.
    pub closest: Vec<CurvePoint>,
    /// All loops that vertices of it are closest to, ascending.
    pub near: Vec<u32>,
    /// How often the rim runs around that loop, against the direction of the section's triangles; `None` when it is
    /// not near it.
    pub turns: Option<i32>,
}

impl RimPlace {
    /// The loop.
    pub fn number(&self) -> usize {
        self.closest[0].number as usize
    }

    pub fn new(curve: &Curve, mesh: &TriMesh, rim: &[u32], reach: Reach) -> RimPlace {
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
        let near = counts.into_keys().collect();
        let is_near = closest.iter().all(|c| c.distance <= reach.across);
        let turns = is_near.then_some(-(turned / whole).round() as i32);
        RimPlace { points, closest, near, turns }
    }
}

/// What a rim is to the loop near it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Match {
    /// It runs around it once.
    Around,
    /// So few vertices that nobody can tell, and no other rim is there for the loop.
    Small,
    /// It runs around nothing.
    Stray,
    /// It runs around it more than once, or another one does, too.
    Tangled,
}

/// Vertices of a loop and of its rim, multiplied, up to which all strips between them are looked at: a millisecond.
const SMALL: usize = 1 << 16;

/// What each rim is.
pub(crate) fn matches(places: &[RimPlace], boundary: &Boundary) -> Vec<Match> {
    let mut is_taken = vec![false; boundary.loops.len()];
    let mut found = vec![Match::Stray; places.len()];
    for (found, place) in found.iter_mut().zip(places) {
        *found = match place.turns {
            None | Some(0) => Match::Stray,
            Some(1) if !std::mem::replace(&mut is_taken[place.number()], true) => Match::Around,
            Some(_) => Match::Tangled,
        };
    }
    for (found, place) in found.iter_mut().zip(places) {
        let is_small = place.points.len() * boundary.loops[place.number()].len() <= SMALL;
        if matches!(place.turns, Some(0 | -1))
            && is_small
            && !std::mem::replace(&mut is_taken[place.number()], true)
        {
            *found = Match::Small;
        }
    }
    found
}
