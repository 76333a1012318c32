//! Lists of triangles: all that come near enough to one of eight points, and the closest of a list.

use super::node::{Level, WIDTH};
use super::query::{Hit, Stack};
use super::{NearestOfEight, Ssvh};
use crate::geom::lanes::{F64s, in_lanes};
use crate::geom::triangle::Triangle;
use glam::DVec3;
use multiversion::multiversion;
use pulp::{Simd, WithSimd};

impl Ssvh {
    /// Appends to `found` the positions, in the hierarchy's order, of all triangles whose distance from one of the
    /// points is at most that point's limit, and of some that are a little farther.
    pub fn collect(&self, points: &[DVec3; 8], limits: &[f64; 8], found: &mut Vec<u32>) {
        collect(self, points, limits, found);
    }

    /// The triangle at a position of the hierarchy's order.
    #[inline]
    pub fn triangle_at(&self, position: u32) -> &Triangle {
        &self.triangles[position as usize]
    }

    /// The mesh number of the triangle at a position of the hierarchy's order.
    #[inline]
    pub fn id_at(&self, position: u32) -> u32 {
        self.ids[position as usize]
    }

    /// The triangle at a position of the hierarchy's order, with its squared distance from `p`.
    #[inline]
    pub fn hit(&self, position: u32, p: DVec3) -> Hit {
        Hit {
            triangle: self.id_at(position),
            distance_squared: self.triangle_at(position).distance_squared(p),
        }
    }

    /// The closest to eight points of the triangles at `positions`, as [`closest`](Self::closest) finds it among all.
    ///
    /// # Panics
    /// When there are none.
    pub fn closest_of_to_eight(&self, positions: &[u32], points: &[DVec3; 8]) -> [Hit; 8] {
        assert!(!positions.is_empty(), "a list of triangles");
        let points = [points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)];
        in_lanes(ClosestToEight { ssvh: self, positions, points: &points })
    }
}

/// The closest of a list to eight points.
struct ClosestToEight<'a> {
    ssvh: &'a Ssvh,
    positions: &'a [u32],
    points: &'a [[f64; 8]; 3],
}

impl WithSimd for ClosestToEight<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let ClosestToEight { ssvh, positions, points } = self;
        let mut nearest = NearestOfEight::NONE;
        for &position in positions {
            let triangle = ssvh.triangle_at(position).in_lanes(simd);
            for vector in 0..8 / F64s::<S>::COUNT {
                nearest.offer(simd, &triangle, ssvh.id_at(position), points, vector);
            }
        }
        nearest.hits()
    }
}

#[multiversion(targets("x86_64+avx2+bmi1+bmi2+lzcnt+popcnt"))]
#[allow(clippy::needless_range_loop, reason = "a lane runs through several arrays in step")]
fn collect(tree: &Ssvh, points: &[DVec3; 8], limits: &[f64; 8], found: &mut Vec<u32>) {
    let lo = points.iter().copied().reduce(DVec3::min).expect("eight points");
    let hi = points.iter().copied().reduce(DVec3::max).expect("eight points");
    let centre = lo.midpoint(hi);
    let radius = points.iter().map(|&p| (p - centre).length_squared()).fold(0.0, f64::max).sqrt();
    let slack = tree.slack((centre - tree.centre).abs() + radius);
    let limits = limits.map(|limit| ((limit + slack) as f32).next_up());
    let limit = limits.iter().fold(0.0, |a: f32, &b| a.max(b)) + (radius as f32).next_up();
    let relative = points.map(|p| (p - tree.centre).as_vec3());
    let relative = [relative.map(|p| p.x), relative.map(|p| p.y), relative.map(|p| p.z)];
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
            match node.level {
                Level::Inner => stack.push(first, distances[slot], node.children[slot]),
                Level::Leaf => found.push(node.children[slot]),
            }
        }
    }
}
