//! Closest-triangle queries, for one point and for eight that are near each other.

use super::Ssvh;
use super::node::{Level, Node, WIDTH};
use crate::geom::triangle::Eight;
use glam::{DVec3, Vec3};
use multiversion::multiversion;

/// The closest triangle to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The triangle's number in the mesh.
    pub triangle: u32,
    /// Squared distance of the point from it.
    pub distance_squared: f64,
}

impl Hit {
    /// Whether this hit comes before `other`: nearer, or as near with the lower number.
    #[inline(always)]
    pub fn before(&self, other: &Hit) -> bool {
        self.distance_squared < other.distance_squared
            || (self.distance_squared == other.distance_squared && self.triangle < other.triangle)
    }
}

/// Rounding of a bound in units of the distances involved: 64 units in the last place of f32. The bound
/// takes a few dozen roundings, each of at most half a unit. Too large would only visit more nodes; too
/// small could lose the closest triangle.
const SLACK: f64 = 64.0 / 16_777_216.0;

/// The deepest stack: at most 11 levels of nodes for 2^32 triangles, and 7 siblings wait on each.
const STACK: usize = 11 * (WIDTH - 1) + 1;

impl Ssvh {
    /// The closest triangle to `p`. Equal distances go to the lowest triangle number.
    pub fn closest(&self, p: DVec3) -> Hit {
        self.closest_from(p, self.ids[0])
    }

    /// The same as [`closest`](Self::closest), faster when `guess` is a triangle close to `p`.
    pub fn closest_from(&self, p: DVec3, guess: u32) -> Hit {
        let distance_squared = self.triangles[self.position(guess)].distance_squared(p);
        improve(self, p, Hit { triangle: guess, distance_squared })
    }

    /// The closest triangle if its distance is at most `bound`.
    pub fn closest_within(&self, p: DVec3, bound: f64) -> Option<Hit> {
        // No triangle has this number, so a real one at exactly the bound comes before it.
        let hit = improve(self, p, Hit { triangle: u32::MAX, distance_squared: bound * bound });
        (hit.triangle != u32::MAX).then_some(hit)
    }

    /// The closest triangles to eight points, each as [`closest`](Self::closest) finds it, in one descent:
    /// it pays when the points are about as near to each other as triangles are large, or nearer.
    pub fn closest_to_eight(&self, points: &[DVec3; 8], guess: u32) -> [Hit; 8] {
        improve_eight(self, points, guess)
    }

    /// Rounding of a bound for points whose coordinates relative to the centre are at most `sizes`.
    #[inline(always)]
    pub(super) fn slack(&self, sizes: DVec3) -> f64 {
        SLACK * (sizes.max_element() + self.extent)
    }
}

/// The best of `best` and all triangles of the hierarchy.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn improve(tree: &Ssvh, p: DVec3, mut best: Hit) -> Hit {
    let relative = p - tree.centre;
    let q: Vec3 = relative.as_vec3();
    let slack = tree.slack(relative.abs());
    let limit_of = |hit: &Hit| ((hit.distance_squared.sqrt() + slack) as f32).next_up();
    let mut limit = limit_of(&best);
    let mut stack = Stack::new();
    while let Some(node) = stack.pop(tree, limit) {
        let distances = node.distances(q);
        let first = stack.waiting;
        for (&distance, &child) in distances.iter().zip(&node.children) {
            if distance > limit {
                continue;
            }
            if node.level == Level::Inner {
                stack.push(first, distance, child);
                continue;
            }
            let position = child as usize;
            let hit = Hit {
                triangle: tree.ids[position],
                distance_squared: tree.triangles[position].distance_squared(p),
            };
            if hit.before(&best) {
                best = hit;
                limit = limit_of(&best);
            }
        }
    }
    best
}

/// The closest triangles to eight points. A volume matters when it is near enough to their centre to be
/// near enough to any of them, and then when it is to one of them.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
#[allow(clippy::needless_range_loop, reason = "a lane runs through several arrays in step")]
fn improve_eight(tree: &Ssvh, points: &[DVec3; 8], guess: u32) -> [Hit; 8] {
    let lo = points.iter().copied().reduce(DVec3::min).expect("eight points");
    let hi = points.iter().copied().reduce(DVec3::max).expect("eight points");
    let centre = lo.midpoint(hi);
    let radius = points.iter().map(|&p| (p - centre).length_squared()).fold(0.0, f64::max).sqrt();
    let slack = tree.slack((centre - tree.centre).abs() + radius);
    let radius = (radius as f32).next_up();
    let relative = points.map(|p| (p - tree.centre).as_vec3());
    let relative = [relative.map(|p| p.x), relative.map(|p| p.y), relative.map(|p| p.z)];
    let eight = Eight::from(points);
    let mut nearest = tree.triangles[tree.position(guess)].distances_squared(&eight);
    let mut triangles = [guess; 8];
    let mut limits = [0.0f32; 8];
    let update = |limits: &mut [f32; 8], nearest: &[f64; 8]| -> f32 {
        let mut largest = 0.0f32;
        for i in 0..8 {
            limits[i] = ((nearest[i].sqrt() + slack) as f32).next_up();
            largest = largest.max(limits[i]);
        }
        largest + radius
    };
    let mut limit = update(&mut limits, &nearest);
    let q = (centre - tree.centre).as_vec3();
    let mut stack = Stack::new();
    while let Some(node) = stack.pop(tree, limit) {
        let distances = node.distances(q);
        let first = stack.waiting;
        for slot in 0..WIDTH {
            if distances[slot] > limit {
                continue;
            }
            let from_each = node.distances_from(slot, &relative);
            if !(0..8).fold(false, |any, i| any | (from_each[i] <= limits[i])) {
                continue;
            }
            let child = node.children[slot];
            if node.level == Level::Inner {
                stack.push(first, distances[slot], child);
                continue;
            }
            let triangle = tree.ids[child as usize];
            let found = tree.triangles[child as usize].distances_squared(&eight);
            let mut any = false;
            for i in 0..8 {
                let better = (found[i] < nearest[i]) | ((found[i] == nearest[i]) & (triangle < triangles[i]));
                nearest[i] = if better { found[i] } else { nearest[i] };
                triangles[i] = if better { triangle } else { triangles[i] };
                any |= better;
            }
            if any {
                limit = update(&mut limits, &nearest);
            }
        }
    }
    std::array::from_fn(|i| Hit { triangle: triangles[i], distance_squared: nearest[i] })
}

/// The nodes that wait for their turn, nearest siblings on top.
pub(super) struct Stack {
    entries: [(f32, u32); STACK],
    pub(super) waiting: usize,
}

impl Stack {
    /// The stack with the root on it.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Stack { entries: [(0.0, 0); STACK], waiting: 1 }
    }

    /// The next node whose volume is within `limit`.
    #[inline(always)]
    pub(super) fn pop<'t>(&mut self, tree: &'t Ssvh, limit: f32) -> Option<&'t Node> {
        while self.waiting > 0 {
            self.waiting -= 1;
            let (bound, number) = self.entries[self.waiting];
            if bound <= limit {
                return Some(&tree.nodes[number as usize]);
            }
        }
        None
    }

    /// Puts a node among its siblings, which begin at `first`.
    #[inline(always)]
    pub(super) fn push(&mut self, first: usize, distance: f32, number: u32) {
        let mut at = self.waiting;
        while at > first && self.entries[at - 1].0 < distance {
            self.entries[at] = self.entries[at - 1];
            at -= 1;
        }
        self.entries[at] = (distance, number);
        self.waiting += 1;
    }
}
