//! Closest point on a triangle, with the feature it lies on (Eberly's seven regions).
//!
//! The regions are told apart by the three planes through the edges that are perpendicular to the
//! triangle, and each edge region by its two end planes. No barycentric division takes part in the
//! decision, so needles keep their accuracy.

use super::simd::{F64s, Vec3F64s};
use glam::DVec3;
use pulp::Simd;

/// A corner or an edge of a triangle: 0, 1 or 2. Edge k runs from corner k to corner k + 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TriangleSide(u8);

impl TriangleSide {
    /// The three sides.
    pub const ALL: [TriangleSide; 3] = [TriangleSide(0), TriangleSide(1), TriangleSide(2)];

    /// Returns the number: 0, 1 or 2.
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns the side after this one, cyclically.
    pub const fn next(self) -> TriangleSide {
        TriangleSide((self.0 + 1) % 3)
    }
}

/// The part of a triangle that a closest point lies on (\[LW11\] Definition 4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Feature {
    /// The interior of the triangle.
    Face,
    /// The interior of an edge.
    Edge(TriangleSide),
    /// A corner.
    Vertex(TriangleSide),
}

/// Twice the area, relative to the squared longest edge, below which a triangle counts as a
/// segment. Its normal would carry fewer than five digits, while its height is below 1e-11 of its
/// length: leaving out the interior moves no distance by more than that.
const NEEDLE_RATIO: f64 = 1e-11;

/// A triangle ready for distance evaluation: corners and unit normal (zero for a needle that has
/// none).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Corner positions.
    pub corners: [DVec3; 3],
    /// Unit normal by the right-hand rule, or zero.
    pub normal: DVec3,
    /// Bit k: edge k runs from its second corner to its first, for canonical arithmetic (see
    /// `segment`).
    flipped: u8,
}

/// A triangle for the distances of many points.
#[derive(Clone, Copy, Debug)]
pub struct SplatTriangle<S: Simd> {
    sides: [SplatEdge<S>; 3],
    corner: Vec3F64s<S>,
    normal: Vec3F64s<S>,
}

/// An edge of a triangle.
#[derive(Clone, Copy, Debug)]
struct SplatEdge<S: Simd> {
    corner: Vec3F64s<S>,
    /// Vector in the triangle's plane, perpendicular to the edge.
    outward: Vec3F64s<S>,
    /// The end with the lower vertex number.
    start: Vec3F64s<S>,
    /// The end with the higher vertex number.
    end: Vec3F64s<S>,
}

impl<S: Simd> SplatTriangle<S> {
    /// Returns the squared distances from the points in `p`, each bit for bit the value that
    /// [`Triangle::distance_squared`] returns.
    #[inline(always)]
    pub fn distances_squared(&self, simd: S, p: Vec3F64s<S>) -> F64s<S> {
        let zero = F64s::splat(simd, 0.0);
        let far = F64s::splat(simd, f64::INFINITY);
        let [first, second, third] = &self.sides;
        // Written out: closures would not be compiled for the kernel's instructions.
        let outside = [first.outside(p), second.outside(p), third.outside(p)];
        // Negative inside all edges.
        let outermost = outside[0].max(outside[1]).max(outside[2]);
        let inside = outermost.less(zero);
        let height = (p - self.corner).dot(self.normal);
        let mut nearest = far;
        for (side, outside) in [(first, outside[0]), (second, outside[1]), (third, outside[2])] {
            let beyond = zero.at_most(outside);
            if beyond.any() {
                nearest = nearest.min(beyond.select(side.distances_squared(simd, p), far));
            }
        }
        inside.select(height * height, nearest)
    }
}

impl<S: Simd> SplatEdge<S> {
    #[inline(always)]
    fn new(a: Vec3F64s<S>, b: Vec3F64s<S>, normal: Vec3F64s<S>, is_flipped: bool) -> SplatEdge<S> {
        let (start, end) = if is_flipped { (b, a) } else { (a, b) };
        SplatEdge { corner: a, outward: (b - a).cross(normal), start, end }
    }

    /// Returns the numbers that [`Triangle::outside`] returns for one edge.
    #[inline(always)]
    fn outside(&self, p: Vec3F64s<S>) -> F64s<S> {
        (p - self.corner).dot(self.outward)
    }

    /// Returns the squared distances from the edge, by the arithmetic of `Triangle::segment`.
    #[inline(always)]
    fn distances_squared(&self, simd: S, p: Vec3F64s<S>) -> F64s<S> {
        let edge = self.end - self.start;
        let length_squared = edge.dot(edge);
        let along = (p - self.start).dot(edge);
        let inverse = F64s::splat(simd, 1.0) / length_squared;
        let between = self.start + edge.times(along * inverse);
        let point = length_squared.at_most(along).select_points(self.end, between);
        let point = along.at_most(F64s::splat(simd, 0.0)).select_points(self.start, point);
        let from = p - point;
        from.dot(from)
    }
}

/// The closest point of a triangle to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// The closest point.
    pub point: DVec3,
    /// Squared distance from the query point.
    pub distance_squared: f64,
    /// Feature that the closest point lies on.
    pub feature: Feature,
}

impl Triangle {
    /// Returns the triangle with the given corners, whose vertices have the given numbers in their
    /// mesh. The numbers only fix the direction in which an edge is evaluated: both triangles of an
    /// edge then compute the same distance to it, to the last bit.
    pub fn new(corners: [DVec3; 3], vertices: [u32; 3]) -> Self {
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        let length = cross.length();
        let normal = if length > NEEDLE_RATIO * longest { cross / length } else { DVec3::ZERO };
        let flipped = (0..3).filter(|&k| vertices[k] > vertices[(k + 1) % 3]).fold(0, |f, k| f | 1 << k);
        Triangle { corners, normal, flipped }
    }

    /// Returns the squared distance from `p`, bit for bit the value of [`closest`](Self::closest).
    #[inline(always)]
    pub fn distance_squared(&self, p: DVec3) -> f64 {
        let outside = self.outside(p);
        if outside.iter().all(|&x| x < 0.0) {
            let height = (p - self.corners[0]).dot(self.normal);
            return height * height;
        }
        let mut best = f64::INFINITY;
        for side in TriangleSide::ALL {
            // The closest edge is one whose plane the point is not inside of; a needle (all zero)
            // takes all three.
            if outside[side.index()] >= 0.0 {
                best = best.min(self.segment(side, p).1);
            }
        }
        best
    }

    /// Returns the triangle for the distances of many points, with all that depends on no point
    /// computed ahead.
    #[inline(always)]
    pub fn splat<S: Simd>(&self, simd: S) -> SplatTriangle<S> {
        let a = Vec3F64s::splat(simd, self.corners[0].to_array());
        let b = Vec3F64s::splat(simd, self.corners[1].to_array());
        let c = Vec3F64s::splat(simd, self.corners[2].to_array());
        let normal = Vec3F64s::splat(simd, self.normal.to_array());
        SplatTriangle {
            sides: [
                SplatEdge::new(a, b, normal, self.flipped & 1 == 1),
                SplatEdge::new(b, c, normal, self.flipped >> 1 & 1 == 1),
                SplatEdge::new(c, a, normal, self.flipped >> 2 & 1 == 1),
            ],
            corner: a,
            normal,
        }
    }

    /// Returns the ends of an edge, the one with the lower vertex number first.
    #[inline(always)]
    fn ends(&self, side: TriangleSide) -> (TriangleSide, TriangleSide) {
        if self.flipped >> side.0 & 1 == 1 { (side.next(), side) } else { (side, side.next()) }
    }

    /// Returns the closest point to `p`. Of two edges at the same distance the one with the lower
    /// number counts.
    pub fn closest(&self, p: DVec3) -> ClosestPoint {
        let outside = self.outside(p);
        if outside.iter().all(|&x| x < 0.0) {
            let height = (p - self.corners[0]).dot(self.normal);
            return ClosestPoint {
                point: p - self.normal * height,
                distance_squared: height * height,
                feature: Feature::Face,
            };
        }
        let mut best =
            ClosestPoint { point: DVec3::NAN, distance_squared: f64::INFINITY, feature: Feature::Face };
        for side in TriangleSide::ALL {
            if outside[side.index()] >= 0.0 {
                let (point, distance_squared, feature) = self.segment(side, p);
                if distance_squared < best.distance_squared {
                    best = ClosestPoint { point, distance_squared, feature };
                }
            }
        }
        best
    }

    /// Returns the feature that the closest point to `p` lies on, as [`closest`](Self::closest)
    /// finds it: faster, since where `p` is beyond one edge no distance is needed.
    #[inline]
    pub fn feature(&self, p: DVec3) -> Feature {
        let beyond = self.outside(p).map(|x| x >= 0.0);
        let side = match beyond {
            [false, false, false] => return Feature::Face,
            [true, false, false] => TriangleSide::ALL[0],
            [false, true, false] => TriangleSide::ALL[1],
            [false, false, true] => TriangleSide::ALL[2],
            _ => return self.closest(p).feature,
        };
        let (first, second) = self.ends(side);
        let (a, b) = (self.corners[first.index()], self.corners[second.index()]);
        let along = (p - a).dot(b - a);
        if along <= 0.0 {
            Feature::Vertex(first)
        } else if along >= (b - a).length_squared() {
            Feature::Vertex(second)
        } else {
            Feature::Edge(side)
        }
    }

    /// Returns the parameters (u, v) of `point` on the triangle: t(u, v) = b + u e0 + v e1, with b
    /// the first corner, and e0 and e1 the edges from it to the second and third; u, v >= 0, u + v
    /// <= 1.
    pub fn parameters(&self, point: DVec3) -> [f64; 2] {
        let twice_area = self.outside(point).map(|x| (-x).max(0.0));
        let sum = twice_area[0] + twice_area[1] + twice_area[2];
        if sum > 0.0 {
            // The weight of a corner is the area opposite to it: edge 2 faces corner 1, edge 0
            // corner 2.
            return [twice_area[2] / sum, twice_area[0] / sum];
        }
        // A needle: the position along its longest edge.
        let longest = TriangleSide::ALL
            .into_iter()
            .max_by(|&j, &k| self.edge(j).length_squared().total_cmp(&self.edge(k).length_squared()))
            .expect("three sides");
        let edge = self.edge(longest);
        let along = (point - self.corners[longest.index()]).dot(edge) / edge.length_squared();
        let mut weights = [0.0; 3];
        weights[longest.index()] = 1.0 - along.clamp(0.0, 1.0);
        weights[longest.next().index()] = along.clamp(0.0, 1.0);
        [weights[1], weights[2]]
    }

    /// Returns the vector of an edge, from the corner of the same number to the next.
    pub fn edge(&self, side: TriangleSide) -> DVec3 {
        self.corners[side.next().index()] - self.corners[side.index()]
    }

    /// Returns, for each edge, the distance of `p` from the plane through the edge perpendicular to
    /// the triangle, positive outside, times the edge's length.
    #[inline(always)]
    pub fn outside(&self, p: DVec3) -> [f64; 3] {
        let [a, b, c] = self.corners;
        [
            (p - a).dot((b - a).cross(self.normal)),
            (p - b).dot((c - b).cross(self.normal)),
            (p - c).dot((a - c).cross(self.normal)),
        ]
    }

    /// Returns the closest point on an edge, its squared distance and its feature. The edge is
    /// evaluated from the end with the lower vertex number, so that the triangles of an edge agree.
    #[inline(always)]
    fn segment(&self, side: TriangleSide, p: DVec3) -> (DVec3, f64, Feature) {
        let (first, second) = self.ends(side);
        let (a, b) = (self.corners[first.index()], self.corners[second.index()]);
        let edge = b - a;
        let length_squared = edge.length_squared();
        let along = (p - a).dot(edge);
        let (point, feature) = if along <= 0.0 {
            (a, Feature::Vertex(first))
        } else if along >= length_squared {
            (b, Feature::Vertex(second))
        } else {
            (a + edge * (along * (1.0 / length_squared)), Feature::Edge(side))
        };
        (point, (p - point).length_squared(), feature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> Triangle {
        Triangle::new([DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)], [0, 1, 2])
    }

    #[test]
    fn each_of_the_seven_regions() {
        let t = triangle();
        let cases = [
            ([1.0, 1.0, 2.0], Feature::Face, 4.0),
            ([2.0, -1.0, 1.0], Feature::Edge(TriangleSide(0)), 2.0),
            ([4.0, 4.0, 0.0], Feature::Edge(TriangleSide(1)), 6.4 * 6.4 * 0.25),
            ([-2.0, 1.0, 0.0], Feature::Edge(TriangleSide(2)), 4.0),
            ([-1.0, -1.0, 1.0], Feature::Vertex(TriangleSide(0)), 3.0),
            ([6.0, -1.0, 0.0], Feature::Vertex(TriangleSide(1)), 5.0),
            ([-1.0, 5.0, 0.0], Feature::Vertex(TriangleSide(2)), 5.0),
        ];
        for (p, feature, d2) in cases {
            let p = DVec3::from(p);
            let closest = t.closest(p);
            assert_eq!(closest.feature, feature, "{p}");
            assert!((closest.distance_squared - d2).abs() < 1e-12, "{p}: {closest:?}");
            assert_eq!(closest.distance_squared, t.distance_squared(p));
        }
    }

    #[test]
    fn parameters_give_the_point_back() {
        let t = triangle();
        for p in [DVec3::new(1.0, 1.0, 5.0), DVec3::new(2.0, -3.0, 0.0), DVec3::new(-1.0, 9.0, 1.0)] {
            let point = t.closest(p).point;
            let [u, v] = t.parameters(point);
            let back = t.corners[0] + u * (t.corners[1] - t.corners[0]) + v * (t.corners[2] - t.corners[0]);
            assert!((back - point).length() < 1e-12, "{p}: {u} {v}");
        }
    }

    #[test]
    fn eight_points_at_once_are_one_at_a_time() {
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for n in 0..2000u32 {
            let mut point = || DVec3::new(random(), random(), random());
            let mut corners = [point(), point(), point()];
            if n % 3 == 0 {
                corners[2] = corners[0] * 0.3 + corners[1] * 0.7 + 1e-13 * corners[2];
            }
            let triangle = Triangle::new(corners, [n % 5, 2, 7 - n % 7]);
            let mut points: [DVec3; 8] = std::array::from_fn(|_| 3.0 * point());
            points[0] = corners[1];
            points[1] = corners[0].midpoint(corners[2]);
            for p in points {
                assert_eq!(triangle.feature(p), triangle.closest(p).feature, "{p} {corners:?}");
            }
            let one_by_one = points.map(|p| triangle.distance_squared(p));
            let lanes = [points.map(|p| p.x), points.map(|p| p.y), points.map(|p| p.z)];
            let here = crate::geom::simd::dispatch(SquaredDistances(&triangle, &lanes));
            let anywhere = pulp::WithSimd::with_simd(SquaredDistances(&triangle, &lanes), pulp::Scalar);
            assert_eq!(here.map(f64::to_bits), one_by_one.map(f64::to_bits), "{corners:?}");
            assert_eq!(here.map(f64::to_bits), anywhere.map(f64::to_bits), "{corners:?}");
        }
    }

    struct SquaredDistances<'a>(&'a Triangle, &'a [[f64; 8]; 3]);

    impl pulp::WithSimd for SquaredDistances<'_> {
        type Output = [f64; 8];
        fn with_simd<S: Simd>(self, simd: S) -> [f64; 8] {
            let mut out = [0.0; 8];
            for vector in 0..8 / F64s::<S>::COUNT {
                let p = Vec3F64s::load(simd, self.1, vector);
                self.0.splat(simd).distances_squared(simd, p).store(&mut out, vector);
            }
            out
        }
    }

    #[test]
    fn a_needle_is_its_edges() {
        let corners = [DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.5, 1e-14, 0.0)];
        let t = Triangle::new(corners, [0, 1, 2]);
        assert_eq!(t.normal, DVec3::ZERO);
        let closest = t.closest(DVec3::new(0.25, 0.0, 2.0));
        assert!((closest.distance_squared - 4.0).abs() < 1e-12);
        assert!(matches!(closest.feature, Feature::Edge(_)));
    }

    #[test]
    fn both_triangles_of_an_edge_agree_to_the_last_bit() {
        let a = DVec3::new(0.1, 0.7, -0.3);
        let b = DVec3::new(1.3, 0.2, 0.9);
        let left = Triangle::new([a, b, DVec3::new(0.2, -3.0, 0.0)], [5, 3, 8]);
        let right = Triangle::new([b, a, DVec3::new(0.1, 2.5, 0.4)], [3, 5, 9]);
        let p = DVec3::new(1.7, 0.45, -0.7);
        let (l, r) = (left.closest(p), right.closest(p));
        if matches!((l.feature, r.feature), (Feature::Edge(_), Feature::Edge(_))) {
            assert_eq!(l.distance_squared, r.distance_squared);
            assert_eq!(l.point, r.point);
        } else {
            panic!("the point was meant to be closest to the edge: {l:?} {r:?}");
        }
    }
}
