//! The nearest triangles of eight points while candidates are gone through.

use super::query::{Hit, widened};
use super::{Ssvh, TriangleSlot};
use crate::geom::simd::{F64s, Vec3F64s};
use crate::geom::triangle::SplatTriangle;
use pulp::Simd;

/// The best so far of eight points.
#[derive(Clone, Copy, Debug)]
pub struct Closest8 {
    /// Squared distances; infinite where nothing was offered yet.
    pub squared: [f64; 8],
    /// Triangle numbers: all 32-bit numbers are numbers of 64-bit floats.
    ids: [f64; 8],
}

impl Closest8 {
    /// The state before anything is offered.
    pub const NONE: Closest8 = Closest8 { squared: [f64::INFINITY; 8], ids: [f64::INFINITY; 8] };

    /// Offers the triangle with number `id` to the points of one vector. Of equally near ones the
    /// lowest number stays, as in [`Hit::before`].
    #[inline(always)]
    pub fn offer<S: Simd>(
        &mut self,
        simd: S,
        triangle: &SplatTriangle<S>,
        id: u32,
        points: &[[f64; 8]; 3],
        vector: usize,
    ) {
        let id = F64s::splat(simd, f64::from(id));
        let found = triangle.distances_squared(simd, Vec3F64s::load(simd, points, vector));
        let (nearest, ids) = (F64s::load(simd, &self.squared, vector), F64s::load(simd, &self.ids, vector));
        let before = found.less(nearest) | (found.at_most(nearest) & id.less(ids));
        before.select(found, nearest).store(&mut self.squared, vector);
        before.select(id, ids).store(&mut self.ids, vector);
    }

    /// Returns the state before anything is offered, with triangle `id` infinitely far: there is a
    /// triangle whatever is offered.
    #[inline(always)]
    pub(super) fn unless_nearer(id: u32) -> Closest8 {
        Closest8 { ids: [f64::from(id); 8], ..Closest8::NONE }
    }

    /// Offers the triangle at a slot of the hierarchy's order to all points.
    #[inline(always)]
    pub fn offer_to_all<S: Simd>(
        &mut self,
        simd: S,
        tree: &Ssvh,
        slot: TriangleSlot,
        points: &[[f64; 8]; 3],
    ) {
        let triangle = tree.triangle_at(slot).splat(simd);
        for vector in 0..8 / F64s::<S>::COUNT {
            self.offer(simd, &triangle, tree.id_at(slot), points, vector);
        }
    }

    /// Sets the distance within which a triangle matters to each point. `slack` is the error of
    /// bounds.
    #[inline(always)]
    pub(super) fn limits(&self, slack: f64, limits: &mut [f32; 8]) {
        for (limit, &squared) in limits.iter_mut().zip(&self.squared) {
            *limit = widened(squared, slack);
        }
    }

    /// Returns the closest triangles; without meaning for points that nothing was offered to.
    #[inline(always)]
    pub fn hits(&self) -> [Hit; 8] {
        let mut hits = [Hit { triangle: 0, distance_squared: 0.0 }; 8];
        for (i, hit) in hits.iter_mut().enumerate() {
            *hit = Hit { triangle: self.ids[i] as u32, distance_squared: self.squared[i] };
        }
        hits
    }
}
