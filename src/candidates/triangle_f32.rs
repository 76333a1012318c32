//! A triangle in f32, for bounds of the distances of eight points at a time.

use crate::geom::simd::{F32s, Vec3F32s};
use crate::geom::triangle::Triangle;
use glam::{DVec3, Vec3};
use pulp::Simd;

/// Eight points as structure of arrays.
pub type EightPoints = [[f32; 8]; 3];

/// Rounding error of a distance from a [`TriangleF32`], relative to the largest coordinate: 64
/// units in the last place of f32. The computation takes some twenty roundings of half a unit each.
/// A larger value only keeps more triangles; a smaller one could lose the closest triangle.
pub(super) const ROUNDING: f32 = 64.0 / 16_777_216.0;

/// A triangle relative to a nearby centre, in voxels.
///
/// Each edge has a frame of unit vectors, in which distances need no closest points.
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleF32 {
    edges: [EdgeF32; 3],
    /// Unit normal.
    normal: [f32; 3],
    /// Height of the centre over the triangle's plane, in voxels.
    height: f32,
}

/// An edge of a triangle and its frame. Lengths are in voxels.
#[derive(Clone, Copy, Debug)]
struct EdgeF32 {
    /// Unit vector along the edge.
    along: [f32; 3],
    /// Coordinate of the centre along the edge, from the edge's first vertex.
    along_of_centre: f32,
    length: f32,
    /// Unit vector in the triangle's plane, perpendicular to the edge, away from the triangle.
    outward: [f32; 3],
    /// Coordinate of the centre along `outward`, from the edge.
    outside: f32,
}

impl EdgeF32 {
    fn new(start: Vec3, along: Vec3, length: f32, outward: Vec3) -> EdgeF32 {
        EdgeF32 {
            along: along.to_array(),
            along_of_centre: -start.dot(along),
            length,
            outward: outward.to_array(),
            outside: -start.dot(outward),
        }
    }
}

impl TriangleF32 {
    /// Returns the triangle seen from `centre`, and the largest coordinate of its corners in
    /// voxels. `scale` is the number of voxels in a model unit.
    pub fn new(triangle: &Triangle, centre: DVec3, scale: f64) -> (TriangleF32, f32) {
        let exact = triangle.corners.map(|c| (c - centre) * scale);
        let corners = exact.map(|c| c.as_vec3());
        let size = corners.iter().fold(0.0, |size: f32, c| size.max(c.abs().max_element()));
        // Differences of rounded corners would not have the direction of a short edge.
        let vectors = [exact[1] - exact[0], exact[2] - exact[1], exact[0] - exact[2]].map(|e| e.as_vec3());
        let squared = vectors.map(|edge| edge.length_squared());
        let normal = triangle.normal.as_vec3();
        if normal == Vec3::ZERO || squared.iter().any(|&x| x < f32::MIN_POSITIVE) {
            return (TriangleF32::needle(corners, vectors, squared), size);
        }
        let edges = std::array::from_fn(|k| {
            let length = squared[k].sqrt();
            let along = vectors[k] * (1.0 / length);
            EdgeF32::new(corners[k], along, length, along.cross(normal))
        });
        (TriangleF32 { edges, normal: normal.to_array(), height: -corners[0].dot(normal) }, size)
    }

    /// Returns a triangle without an interior: its longest edge, with outward vectors to both
    /// sides. Every point is beyond the edge on one side or the other.
    fn needle(corners: [Vec3; 3], vectors: [Vec3; 3], squared: [f32; 3]) -> TriangleF32 {
        let longest = (0..3).fold(0, |longest, k| if squared[k] > squared[longest] { k } else { longest });
        let (start, length) = (corners[longest], squared[longest].sqrt());
        let along = vectors[longest].try_normalize().unwrap_or(Vec3::X);
        let (normal, outward) = along.any_orthonormal_pair();
        let edge = |outward| EdgeF32::new(start, along, length, outward);
        let edges = [edge(outward), edge(-outward), edge(outward)];
        TriangleF32 { edges, normal: normal.to_array(), height: -start.dot(normal) }
    }

    /// Returns the least and the largest height over the triangle's plane of a cube of width 2
    /// `half` around `centre`, in voxels, but for rounding. For a needle the range holds zero if
    /// the needle is near enough.
    pub fn heights(&self, centre: [f32; 3], half: f32) -> [f32; 2] {
        let sum = |f: &dyn Fn(usize) -> f32| f(0) + f(1) + f(2);
        let middle = self.height + sum(&|i| self.normal[i] * centre[i]);
        let radius = half * sum(&|i| self.normal[i].abs());
        [middle - radius, middle + radius]
    }

    /// Returns the distances of the points `p`, their inverses, and the unit vectors to the points
    /// from their closest points. All regions are computed and the right one is selected, so that
    /// all lanes take the same instructions.
    #[inline(always)]
    pub fn distances<S: Simd>(&self, simd: S, p: Vec3F32s<S>) -> (F32s<S>, F32s<S>, Vec3F32s<S>) {
        let (zero, one) = (F32s::splat(simd, 0.0), F32s::splat(simd, 1.0));
        let tiny = F32s::splat(simd, f32::MIN_POSITIVE);
        let mut squared = F32s::splat(simd, f32::INFINITY);
        let mut outermost = F32s::splat(simd, f32::NEG_INFINITY);
        let mut beside = Vec3F32s::splat(simd, [0.0; 3]);
        for edge in &self.edges {
            let (along, outward) = (Vec3F32s::splat(simd, edge.along), Vec3F32s::splat(simd, edge.outward));
            let position = along.dot_plus(p, F32s::splat(simd, edge.along_of_centre));
            let outside = outward.dot_plus(p, F32s::splat(simd, edge.outside));
            outermost = outermost.max(outside);
            let beyond = position - position.max(zero).min(F32s::splat(simd, edge.length));
            let square = beyond.times_plus(beyond, outside * outside);
            let nearer = zero.at_most(outside) & square.less(squared);
            squared = nearer.select(square, squared);
            beside = nearer.select_points(along.times_plus(beyond, outward.times(outside)), beside);
        }
        let normal = Vec3F32s::splat(simd, self.normal);
        let height = normal.dot_plus(p, F32s::splat(simd, self.height));
        let squared = outermost.less(zero).select(zero, squared);
        let distance = height.times_plus(height, squared).sqrt();
        let from = normal.times_plus(height, beside);
        // Zero has no direction; whoever reads it there must not depend on it.
        let inverse = one / distance.max(tiny);
        (distance, inverse, from.times(inverse))
    }
}
