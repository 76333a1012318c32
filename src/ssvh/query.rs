//! Closest-triangle queries, for one point and for eight that are near each other.

use super::node::{Level, Node, WIDTH};
use super::{Closest8, Ssvh, TriangleSlot};
use crate::geom::simd::dispatch;
use glam::{DVec3, Vec3};
use pulp::{Simd, WithSimd};

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

/// Rounding error of a bound relative to the distances involved: 64 units in the last place of f32.
/// The bound takes a few dozen roundings, each of at most half a unit. A larger value would only
/// visit more nodes; a smaller one could lose the closest triangle.
const BOUND_ROUNDING: f64 = 64.0 / 16_777_216.0;

/// The largest number of entries on the stack: at most 11 levels of nodes for 2^32 triangles, and 7
/// siblings wait on each.
const STACK_SIZE: usize = 11 * (WIDTH - 1) + 1;

impl Ssvh {
    /// Returns the closest triangle to `p`. Equal distances go to the lowest triangle number.
    pub fn closest(&self, p: DVec3) -> Hit {
        self.closest_from(p, self.ids[0])
    }

    /// Returns what [`closest`](Self::closest) returns, faster when `guess` is a triangle close to
    /// `p`.
    pub fn closest_from(&self, p: DVec3, guess: u32) -> Hit {
        let distance_squared = self.triangle(guess).distance_squared(p);
        dispatch(Improve { tree: self, p, best: Hit { triangle: guess, distance_squared } })
    }

    /// Returns the closest triangle if its distance is at most `bound`.
    pub fn closest_within(&self, p: DVec3, bound: f64) -> Option<Hit> {
        // No triangle has this number, so a real one at exactly the bound comes before it.
        let best = Hit { triangle: u32::MAX, distance_squared: bound * bound };
        let hit = dispatch(Improve { tree: self, p, best });
        (hit.triangle != u32::MAX).then_some(hit)
    }

    /// Returns the closest triangles to eight points, each as [`closest`](Self::closest) finds it,
    /// in one descent: it pays when the points are about as near to each other as triangles are
    /// large, or nearer.
    pub fn closest8(&self, points: &[DVec3; 8], guess: u32) -> [Hit; 8] {
        dispatch(Improve8 { tree: self, points, guess })
    }

    /// Rounding of a bound for points whose coordinates relative to the centre are at most `sizes`.
    #[inline(always)]
    pub(super) fn slack(&self, sizes: DVec3) -> f64 {
        BOUND_ROUNDING * (sizes.max_element() + self.extent)
    }
}

/// The best of `best` and all triangles of the hierarchy.
struct Improve<'a> {
    tree: &'a Ssvh,
    p: DVec3,
    best: Hit,
}

impl WithSimd for Improve<'_> {
    type Output = Hit;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Hit {
        let Improve { tree, p, mut best } = self;
        let relative = p - tree.centre;
        let q: Vec3 = relative.as_vec3();
        let slack = tree.slack(relative.abs());
        let mut limit = widened(best.distance_squared, slack);
        let mut stack = Stack::new();
        while let Some(node) = stack.pop(tree, limit) {
            let distances = node.distances(simd, q);
            let first = stack.waiting;
            for (&distance, &child) in distances.iter().zip(&node.children) {
                if distance > limit {
                    continue;
                }
                if node.level == Level::Inner {
                    stack.push(first, distance, child);
                    continue;
                }
                let slot = child as usize;
                let hit = Hit {
                    triangle: tree.ids[slot],
                    distance_squared: tree.triangles[slot].distance_squared(p),
                };
                if hit.before(&best) {
                    best = hit;
                    limit = widened(best.distance_squared, slack);
                }
            }
        }
        best
    }
}

/// Returns the distance by its square, with what bounds may be too large by.
#[inline(always)]
pub(super) fn widened(squared: f64, slack: f64) -> f32 {
    ((squared.sqrt() + slack) as f32).next_up()
}

/// The closest triangles to eight points.
struct Improve8<'a> {
    tree: &'a Ssvh,
    points: &'a [DVec3; 8],
    guess: u32,
}

impl WithSimd for Improve8<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let Improve8 { tree, points, guess } = self;
        let around = Around::new(tree, points);
        let mut closest = Closest { tree, around: &around, nearest: Closest8::unless_nearer(guess) };
        let mut limits = [0.0; 8];
        closest.visit(simd, tree.slot(guess), &mut limits);
        descend(simd, tree, &around, limits, &mut closest);
        closest.nearest.hits()
    }
}

/// Keeps the nearest.
struct Closest<'a> {
    tree: &'a Ssvh,
    around: &'a Around,
    nearest: Closest8,
}

impl Visit for Closest<'_> {
    #[inline(always)]
    fn visit<S: Simd>(&mut self, simd: S, slot: TriangleSlot, limits: &mut [f32; 8]) -> bool {
        self.nearest.offer_to_all(simd, self.tree, slot, &self.around.exact);
        self.nearest.limits(self.around.slack, limits);
        true
    }
}

/// A visitor of the triangles that a descent for eight points comes to.
pub(super) trait Visit {
    /// Takes the triangle at a slot of the hierarchy's order. May lower the limits, within which of
    /// each point triangles matter. Returns whether to go on.
    fn visit<S: Simd>(&mut self, simd: S, slot: TriangleSlot, limits: &mut [f32; 8]) -> bool;
}

/// Goes down to all triangles that can be within the limits of eight points. A volume matters when
/// it is near enough to their centre to be near enough to any of them, and then when it is to one
/// of them.
#[inline(always)]
pub(super) fn descend<S: Simd>(
    simd: S,
    tree: &Ssvh,
    around: &Around,
    mut limits: [f32; 8],
    visitor: &mut impl Visit,
) {
    let mut limit = largest(&limits) + around.radius;
    let mut stack = Stack::new();
    while let Some(node) = stack.pop(tree, limit) {
        let distances = node.distances(simd, around.centre);
        let first = stack.waiting;
        for (lane, &distance) in distances.iter().enumerate() {
            if distance > limit || !node.is_near(simd, lane, &around.relative, &limits) {
                continue;
            }
            match node.level {
                Level::Inner => stack.push(first, distance, node.children[lane]),
                Level::Leaf => {
                    if !visitor.visit(simd, TriangleSlot(node.children[lane]), &mut limits) {
                        return;
                    }
                    limit = largest(&limits) + around.radius;
                }
            }
        }
    }
}

#[inline(always)]
fn largest(limits: &[f32; 8]) -> f32 {
    let mut largest = 0.0f32;
    for &limit in limits {
        largest = largest.max(limit);
    }
    largest
}

/// Eight points as a hierarchy sees them.
pub(super) struct Around {
    /// The middle of the box around them, relative to the hierarchy's centre.
    pub(super) centre: Vec3,
    /// The largest distance from it.
    pub(super) radius: f32,
    /// Rounding of bounds.
    pub(super) slack: f64,
    /// The points relative to the hierarchy's centre.
    pub(super) relative: [[f32; 8]; 3],
    /// The points.
    pub(super) exact: [[f64; 8]; 3],
}

impl Around {
    #[inline(always)]
    pub(super) fn new(tree: &Ssvh, points: &[DVec3; 8]) -> Around {
        let (mut lo, mut hi) = (points[0], points[0]);
        let (mut relative, mut exact) = ([[0.0; 8]; 3], [[0.0; 8]; 3]);
        for (n, &p) in points.iter().enumerate() {
            (lo, hi) = (lo.min(p), hi.max(p));
            for axis in 0..3 {
                relative[axis][n] = (p[axis] - tree.centre[axis]) as f32;
                exact[axis][n] = p[axis];
            }
        }
        let centre = lo.midpoint(hi);
        let mut radius: f64 = 0.0;
        for &p in points {
            radius = radius.max((p - centre).length_squared());
        }
        let radius = radius.sqrt();
        let slack = tree.slack((centre - tree.centre).abs() + radius);
        let radius = (radius as f32).next_up();
        Around { centre: (centre - tree.centre).as_vec3(), radius, slack, relative, exact }
    }
}

/// The nodes that wait for their turn, nearest siblings on top.
struct Stack {
    entries: [(f32, u32); STACK_SIZE],
    waiting: usize,
}

impl Stack {
    /// Returns the stack with the root on it.
    #[inline(always)]
    fn new() -> Self {
        Stack { entries: [(0.0, 0); STACK_SIZE], waiting: 1 }
    }

    /// Returns the next node whose volume is within `limit`.
    #[inline(always)]
    fn pop<'t>(&mut self, tree: &'t Ssvh, limit: f32) -> Option<&'t Node> {
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
    fn push(&mut self, first: usize, distance: f32, number: u32) {
        let mut at = self.waiting;
        while at > first && self.entries[at - 1].0 < distance {
            self.entries[at] = self.entries[at - 1];
            at -= 1;
        }
        self.entries[at] = (distance, number);
        self.waiting += 1;
    }
}
