//! Depth of a solid: the radius of its largest inscribed ball, by branch and bound.

use super::SignedDistance;
use crate::geom::aabb::Aabb;
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use std::collections::BinaryHeap;

/// The most boxes that are looked at. In plates and needles nearly every box could hold the deepest
/// point, and a search to the last digit does not end. This number takes 2 MB, and a tenth of a
/// second to a second.
const MAX_BOXES: usize = 15_000;

/// Number of boxes between two looks at the cancel token.
const BOXES_PER_CHECK: usize = 256;

/// Depth, relative to the model's half-extent, below which a solid is as good as flat and the
/// search ends.
const NEGLIGIBLE_DEPTH: f64 = 1e-6;

/// Bounds of the radius of the largest ball inside a solid, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Depth {
    /// Depth of the deepest point that was seen; 0 when none was inside.
    pub at_least: f64,
    /// Bound that no point is deeper than.
    pub at_most: f64,
}

/// Searches the deepest inside point, until its depth is known to `relative` (say 1e-3) or the work
/// is no longer worth it.
///
/// Boxes are halved in the order of how deep a point in them could be.
///
/// # Errors
/// When the run is cancelled.
pub fn largest_depth(
    distance: &SignedDistance,
    relative: f64,
    run: &RunSettings,
) -> Result<Depth, Cancelled> {
    let bounds = Aabb::around(distance.mesh().vertices.iter().map(|&v| DVec3::from(v)));
    let half = 0.5 * bounds.size();
    let mut deepest = 0.0f64;
    let mut open = BinaryHeap::new();
    open.push(SearchBox::new(distance, bounds.centre(), half, 0, &mut deepest));
    let negligible = NEGLIGIBLE_DEPTH * half.max_element();
    let mut looked_at = 1;
    while let Some(widest) = open.pop() {
        if looked_at >= MAX_BOXES || widest.bound <= deepest * (1.0 + relative) + negligible {
            return Ok(Depth { at_least: deepest, at_most: widest.bound.max(deepest) });
        }
        if looked_at % BOXES_PER_CHECK < 2 {
            run.check()?;
        }
        for child in widest.halved(distance, &mut deepest) {
            looked_at += 1;
            if child.bound > deepest {
                open.push(child);
            }
        }
    }
    Ok(Depth { at_least: deepest, at_most: deepest })
}

/// An axis-parallel part of space.
struct SearchBox {
    centre: DVec3,
    half: DVec3,
    /// Bound that no point of the box is deeper than, in model units.
    bound: f64,
    /// The triangle that is closest to the centre.
    near: u32,
}

impl SearchBox {
    fn new(distance: &SignedDistance, centre: DVec3, half: DVec3, guess: u32, deepest: &mut f64) -> Self {
        let sample = distance.at(centre, guess);
        *deepest = deepest.max(-sample.distance);
        // Away from the closest side is the opposite one.
        let opposite = distance.at(centre + 0.5 * (centre - sample.closest), sample.triangle);
        *deepest = deepest.max(-opposite.distance);
        let near = [sample.triangle, opposite.triangle];
        // Depths change by no more than the way.
        let lipschitz = half.length() - sample.distance;
        let bound = lipschitz.min(between(distance, centre, half, near));
        SearchBox { centre, half, bound, near: sample.triangle }
    }

    fn halved(&self, distance: &SignedDistance, deepest: &mut f64) -> [SearchBox; 2] {
        let axis = (0..3).fold(0, |a, b| if self.half[b] > self.half[a] { b } else { a });
        let mut half = self.half;
        half[axis] *= 0.5;
        [-1.0, 1.0].map(|side| {
            let mut centre = self.centre;
            centre[axis] += side * half[axis];
            SearchBox::new(distance, centre, half, self.near, deepest)
        })
    }
}

/// Returns a depth that no inside point of a box exceeds: at most half of the way from one triangle
/// to the other.
///
/// A point is no deeper than its distance from either triangle, so no deeper than their mean. That
/// is a convex function, and on a box largest at a corner. Between the sides of a plate it is half
/// of the thickness, however large the box.
fn between(distance: &SignedDistance, centre: DVec3, half: DVec3, near: [u32; 2]) -> f64 {
    let corners = (0..8).map(|n| {
        let sign = |bit: i32| if n >> bit & 1 == 1 { 1.0 } else { -1.0 };
        centre + half * DVec3::new(sign(0), sign(1), sign(2))
    });
    let distances =
        corners.map(|p| near.map(|t| distance.ssvh().triangle(t).closest(p).distance_squared.sqrt()));
    let largest = distances.fold([0.0f64; 2], |[one, both], [a, b]| [one.max(a), both.max(0.5 * (a + b))]);
    largest[0].min(largest[1])
}

impl Ord for SearchBox {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for SearchBox {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for SearchBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for SearchBox {}
