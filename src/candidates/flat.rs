//! A triangle in f32, to bound distances of eight points at a time.

use crate::geom::lanes::{F32s, P32s};
use crate::geom::triangle::{Side, Triangle};
use glam::DVec3;
use pulp::Simd;

/// Eight points as structure of arrays.
pub type EightPoints = [[f32; 8]; 3];

/// Rounding of a distance from a [`FlatTriangle`], in units of the largest coordinate: 64 units in the last place of
/// f32. The computation takes some twenty roundings of half a unit each. Too large only keeps more triangles; too
/// small could lose the closest one.
pub(super) const ROUNDING: f32 = 64.0 / 16_777_216.0;

/// A triangle relative to a nearby centre, in voxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlatTriangle {
    corners: [[f32; 3]; 3],
    /// From each corner to the next.
    edges: [[f32; 3]; 3],
    /// One over the squared lengths of the edges; zero for an edge without length.
    inverse: [f32; 3],
    /// In the triangle's plane, perpendicular to each edge, outward; zero for a needle.
    outward: [[f32; 3]; 3],
    /// Unit normal; zero for a needle.
    normal: [f32; 3],
}

impl FlatTriangle {
    /// The triangle seen from `centre`, `scale` voxels to a model unit.
    pub fn new(triangle: &Triangle, centre: DVec3, scale: f64) -> FlatTriangle {
        let flat = |v: DVec3| v.as_vec3().to_array();
        let edges = Side::ALL.map(|side| triangle.edge(side) * scale);
        FlatTriangle {
            corners: triangle.corners.map(|c| flat((c - centre) * scale)),
            edges: edges.map(flat),
            inverse: edges.map(|e| {
                let inverse = (1.0 / e.length_squared()) as f32;
                if inverse.is_finite() { inverse } else { 0.0 }
            }),
            outward: edges.map(|e| flat(e.cross(triangle.normal))),
            normal: flat(triangle.normal),
        }
    }

    /// The largest coordinate of its corners.
    pub fn size(&self) -> f32 {
        self.corners.as_flattened().iter().fold(0.0, |size, x| size.max(x.abs()))
    }

    /// Between which heights over the triangle's plane the box around `centre` with half-sides `half` is, but for rounding. Zero
    /// is among them for a needle.
    pub fn heights(&self, centre: [f32; 3], half: f32) -> [f32; 2] {
        let sum = |f: &dyn Fn(usize) -> f32| f(0) + f(1) + f(2);
        let middle = sum(&|i| self.normal[i] * (centre[i] - self.corners[0][i]));
        let radius = half * sum(&|i| self.normal[i].abs());
        [middle - radius, middle + radius]
    }

    /// The distances of the points in `p`, and the unit vectors to them from their closest points. All regions are
    /// computed and the right one is selected, so that the lanes run side by side.
    #[inline(always)]
    pub fn distances<S: Simd>(&self, simd: S, p: P32s<S>) -> (F32s<S>, P32s<S>) {
        let (zero, one) = (F32s::splat(simd, 0.0), F32s::splat(simd, 1.0));
        let tiny = F32s::splat(simd, f32::MIN_POSITIVE);
        let mut squared = F32s::splat(simd, f32::INFINITY);
        let mut outermost = F32s::splat(simd, f32::NEG_INFINITY);
        let mut from = P32s::splat(simd, [0.0; 3]);
        for k in 0..3 {
            let edge = P32s::splat(simd, self.edges[k]);
            let at = p - P32s::splat(simd, self.corners[k]);
            let along = (at.dot(edge) * F32s::splat(simd, self.inverse[k])).max(zero).min(one);
            let outside = at.dot(P32s::splat(simd, self.outward[k]));
            outermost = outermost.max(outside);
            let at = at - edge.times(along);
            let length = at.dot(at);
            let nearer = zero.at_most(outside) & length.less(squared);
            squared = nearer.select(length, squared);
            from = nearer.select_points(at, from);
        }
        let normal = P32s::splat(simd, self.normal);
        let height = (p - P32s::splat(simd, self.corners[0])).dot(normal);
        let above = outermost.less(zero);
        let distance = above.select(height * height, squared).sqrt();
        let from = above.select_points(normal.times(height), from);
        // Zero has no direction; whoever reads it there must not depend on it.
        (distance, from.times(one / distance.max(tiny)))
    }
}
