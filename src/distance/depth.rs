//! How deep a solid is: the radius of its largest inscribed ball, by branch and bound.

use super::SignedDistance;
use crate::geom::aabb::Aabb;
use glam::DVec3;
use std::collections::BinaryHeap;

/// The largest distance of an inside point from the surface, at most `relative` (say 1e-3) too small; 0
/// when nothing is inside. Cubes are subdivided in the order of how deep a point in them could be, which
/// is the depth at the centre plus the half-diagonal, since the distance is 1-Lipschitz.
pub fn largest_depth(distance: &SignedDistance, relative: f64) -> f64 {
    let bounds = Aabb::around(distance.mesh().vertices.iter().map(|&v| DVec3::from(v)));
    let half = 0.5 * bounds.size().max_element();
    let mut deepest = 0.0f64;
    let mut open = BinaryHeap::new();
    open.push(Cube::new(distance, bounds.centre(), half, 0, &mut deepest));
    // What is thinner than this part of the model is as good as flat, and ends the search.
    let negligible = 1e-6 * half;
    while let Some(cube) = open.pop() {
        if cube.bound <= deepest * (1.0 + relative) + negligible {
            break;
        }
        for n in 0..8 {
            let sign = |bit: i32| if n >> bit & 1 == 1 { 0.5 } else { -0.5 };
            let centre = cube.centre + cube.half * DVec3::new(sign(0), sign(1), sign(2));
            let child = Cube::new(distance, centre, 0.5 * cube.half, cube.triangle, &mut deepest);
            if child.bound > deepest {
                open.push(child);
            }
        }
    }
    deepest
}

struct Cube {
    centre: DVec3,
    half: f64,
    /// No point of the cube is deeper than this.
    bound: f64,
    triangle: u32,
}

impl Cube {
    fn new(distance: &SignedDistance, centre: DVec3, half: f64, guess: u32, deepest: &mut f64) -> Self {
        let sample = distance.at(centre, guess);
        *deepest = deepest.max(-sample.distance);
        Cube { centre, half, bound: 3f64.sqrt() * half - sample.distance, triangle: sample.triangle }
    }
}

impl Ord for Cube {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

impl PartialOrd for Cube {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cube {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Cube {}
