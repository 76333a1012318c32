//! Lists of triangles: all that come near enough to one of eight points, and the closest of a list.

use super::query::{Around, Hit, Visit, descend};
use super::{Closest8, Ssvh, TriangleSlot};
use crate::geom::simd::dispatch;
use crate::geom::triangle::Triangle;
use glam::DVec3;
use pulp::{Simd, WithSimd};

impl Ssvh {
    /// Appends to `found` the slots, in the hierarchy's order, of all triangles whose distance from
    /// one of the points is at most that point's limit, and of some that are a little farther.
    /// Gives up when `found` holds more than `most`.
    pub fn collect(
        &self,
        points: &[DVec3; 8],
        limits: &[f64; 8],
        most: usize,
        found: &mut Vec<TriangleSlot>,
    ) {
        dispatch(Collect { tree: self, points, limits, most, found });
    }

    /// Returns the triangle at a slot of the hierarchy's order.
    #[inline]
    pub fn triangle_at(&self, slot: TriangleSlot) -> &Triangle {
        &self.triangles[slot.index()]
    }

    /// Returns the mesh number of the triangle at a slot of the hierarchy's order.
    #[inline]
    pub fn id_at(&self, slot: TriangleSlot) -> u32 {
        self.ids[slot.index()]
    }

    /// Returns the triangle at a slot of the hierarchy's order, with its squared distance from `p`.
    #[inline]
    pub fn hit(&self, slot: TriangleSlot, p: DVec3) -> Hit {
        Hit { triangle: self.id_at(slot), distance_squared: self.triangle_at(slot).distance_squared(p) }
    }

    /// Returns the closest to eight points of the triangles at `slots`, as
    /// [`closest`](Self::closest) finds it among all.
    ///
    /// # Panics
    /// When there are none.
    pub fn closest8_among(&self, slots: &[TriangleSlot], points: &[DVec3; 8]) -> [Hit; 8] {
        assert!(!slots.is_empty(), "a list of triangles");
        let points = [points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)];
        dispatch(Closest8Among { ssvh: self, slots, points: &points })
    }
}

/// The closest of a list to eight points.
struct Closest8Among<'a> {
    ssvh: &'a Ssvh,
    slots: &'a [TriangleSlot],
    points: &'a [[f64; 8]; 3],
}

impl WithSimd for Closest8Among<'_> {
    type Output = [Hit; 8];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Hit; 8] {
        let Closest8Among { ssvh, slots, points } = self;
        let mut nearest = Closest8::NONE;
        for &slot in slots {
            nearest.offer_to_all(simd, ssvh, slot, points);
        }
        nearest.hits()
    }
}

/// All triangles that come near enough to one of eight points.
struct Collect<'a> {
    tree: &'a Ssvh,
    points: &'a [DVec3; 8],
    limits: &'a [f64; 8],
    most: usize,
    found: &'a mut Vec<TriangleSlot>,
}

impl WithSimd for Collect<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Collect { tree, points, limits: exact, most, found } = self;
        let around = Around::new(tree, points);
        let mut limits = [0.0; 8];
        for (limit, &exact) in limits.iter_mut().zip(exact) {
            *limit = ((exact + around.slack) as f32).next_up();
        }
        descend(simd, tree, &around, limits, &mut Append { most, found });
    }
}

/// Keeps all.
struct Append<'a> {
    most: usize,
    found: &'a mut Vec<TriangleSlot>,
}

impl Visit for Append<'_> {
    #[inline(always)]
    fn visit<S: Simd>(&mut self, _: S, slot: TriangleSlot, _: &mut [f32; 8]) -> bool {
        self.found.push(slot);
        self.found.len() <= self.most
    }
}
