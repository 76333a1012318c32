//! Swept sphere volumes: all points within a radius of a point, a segment or a rectangle (Larsen et
//! al. 2000).
//!
//! One formula serves all three kinds: a rectangle with one half-length zero is a segment, with
//! both zero a point.

use super::sym3::Sym3;
use glam::DVec3;

/// The kind of a swept sphere volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SweptKind {
    /// A sphere.
    Point,
    /// A capsule.
    Line,
    /// A rounded slab.
    Rectangle,
}

/// A swept sphere volume: everything within `radius` of the rectangle
/// { centre + x u + y v : |x| <= a, |y| <= b }, with a and b in `half`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swept {
    /// Centre of the rectangle.
    pub centre: DVec3,
    /// Unit direction of the longer side.
    pub u: DVec3,
    /// Unit direction of the shorter side, perpendicular to `u`.
    pub v: DVec3,
    /// Half the side lengths along `u` and `v`.
    pub half: [f64; 2],
    /// The radius that is swept over the rectangle.
    pub radius: f64,
}

/// A sphere to be enclosed; a point has radius 0.
pub type Sphere = (DVec3, f64);

impl Swept {
    /// Returns the kind, from the half-lengths.
    pub fn kind(&self) -> SweptKind {
        match self.half {
            [0.0, 0.0] => SweptKind::Point,
            [_, 0.0] => SweptKind::Line,
            _ => SweptKind::Rectangle,
        }
    }

    /// Returns the distance from `p` to the inner rectangle (segment, point).
    pub fn core_distance(&self, p: DVec3) -> f64 {
        self.core_distance_squared(p, self.u.cross(self.v)).sqrt()
    }

    /// Returns a distance that no point of the volume is nearer to `p` than.
    pub fn lower_bound(&self, p: DVec3) -> f64 {
        (self.core_distance(p) - self.radius).max(0.0)
    }

    /// Returns a distance that no point of the volume is farther from `p` than.
    pub fn upper_bound(&self, p: DVec3) -> f64 {
        self.corners().into_iter().map(|c| (p - c).length()).fold(0.0, f64::max) + self.radius
    }

    /// Returns the corners of the rectangle.
    pub fn corners(&self) -> [DVec3; 4] {
        let (x, y) = (self.u * self.half[0], self.v * self.half[1]);
        [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(s, t)| self.centre + x * s + y * t)
    }

    /// Returns the volume: slab, half-cylinders along the four sides, and one sphere from the
    /// corners.
    pub fn volume(&self) -> f64 {
        use std::f64::consts::PI;
        let ([a, b], r) = (self.half, self.radius);
        8.0 * a * b * r + 2.0 * PI * r * r * (a + b) + 4.0 / 3.0 * PI * r * r * r
    }

    /// Returns the best fitting volume around `spheres` (at least one).
    pub fn around(spheres: &[Sphere]) -> Swept {
        Swept::shape_around(spheres).with_radius_around(spheres)
    }

    /// Returns centre, axes and half-lengths of [`around`](Self::around), but for its last digits
    /// the radius, too. Who rounds the volume has to widen it again, and need not do that twice.
    ///
    /// Of point-, line- and rectangle-swept it is the one with the smallest volume, the simpler one
    /// on a tie, with axes by principal components.
    pub fn shape_around(spheres: &[Sphere]) -> Swept {
        let (u, v) = principal_axes(spheres);
        let frame = Frame::new(spheres, u, v);
        let [rectangle, line, point] =
            [SweptKind::Rectangle, SweptKind::Line, SweptKind::Point].map(|kind| frame.fit(kind));
        let best = if line.volume() <= rectangle.volume() { line } else { rectangle };
        if point.volume() <= best.volume() { point } else { best }
    }

    /// Returns the rectangle-swept volume of a triangle, along its longest edge, with the radius 0:
    /// [`with_radius_around`](Self::with_radius_around) its corners gives the one that rounding
    /// needs.
    pub fn shape_around_triangle(corners: [DVec3; 3]) -> Swept {
        let longest = (0..3)
            .max_by(|&i, &j| {
                let length = |k: usize| (corners[(k + 1) % 3] - corners[k]).length_squared();
                length(i).total_cmp(&length(j))
            })
            .expect("three edges");
        let base = corners[(longest + 1) % 3] - corners[longest];
        let u = base.try_normalize().unwrap_or(DVec3::X);
        let apex = corners[(longest + 2) % 3] - corners[longest];
        let v = perpendicular(apex - u * apex.dot(u), u, base.length());
        // The third corner lies between the ends of the longest edge, but for rounding.
        let half = [0.5 * base.length(), 0.5 * apex.dot(v).max(0.0)];
        let centre = corners[longest] + u * half[0] + v * half[1];
        Swept { centre, u, v, half, radius: 0.0 }
    }

    /// Returns this volume with the radius that `spheres` really need, after centre, axes or
    /// half-lengths were rounded.
    pub fn with_radius_around(self, spheres: &[Sphere]) -> Swept {
        let normal = self.u.cross(self.v);
        let radius = farthest(spheres, |p| self.core_distance_squared(p, normal));
        Swept { radius, ..self }
    }

    /// Returns the squared distance from `p` to the inner rectangle, whose unit normal is `normal`.
    #[inline]
    fn core_distance_squared(&self, p: DVec3, normal: DVec3) -> f64 {
        let d = p - self.centre;
        let x = (d.dot(self.u).abs() - self.half[0]).max(0.0);
        let y = (d.dot(self.v).abs() - self.half[1]).max(0.0);
        let z = d.dot(normal);
        x * x + y * y + z * z
    }
}

/// Returns how far the farthest point of `spheres` is from a core, of which `squared` gives the
/// squared distance of a centre. Points share one square root: it never falls where its argument
/// grows.
#[inline]
fn farthest(spheres: &[Sphere], squared: impl Fn(DVec3) -> f64) -> f64 {
    let (mut points, mut others) = (0.0f64, 0.0f64);
    for &(p, r) in spheres {
        if r == 0.0 {
            points = points.max(squared(p));
        } else {
            others = others.max(squared(p).sqrt() + r);
        }
    }
    others.max(points.sqrt())
}

/// Returns the direction of `v`, what is left of a vector of about `size` after its part along the
/// unit vector `u` was taken off. When next to nothing is left, that is rounding and may point
/// anywhere, along `u` too: then some other perpendicular direction.
fn perpendicular(v: DVec3, u: DVec3, size: f64) -> DVec3 {
    if v.length() <= 1e-9 * size {
        return u.any_orthonormal_vector();
    }
    // Once more, since the first time left rounding relative to the larger vector.
    let v = v.normalize();
    (v - u * v.dot(u)).normalize()
}

fn principal_axes(spheres: &[Sphere]) -> (DVec3, DVec3) {
    let mean = spheres.iter().map(|s| s.0).sum::<DVec3>() / spheres.len() as f64;
    let mut covariance = Sym3::default();
    for &(p, _) in spheres {
        covariance.add_outer((p - mean).to_array());
    }
    let [u, v, _] = covariance.eigen().vectors.map(DVec3::from);
    (u, v)
}

/// Spheres seen along the axes of a volume.
struct Frame {
    origin: DVec3,
    axes: [DVec3; 3],
    /// Coordinates along the axes.
    spheres: Vec<Sphere>,
    /// The middle of the box around them.
    mid: DVec3,
}

impl Frame {
    fn new(spheres: &[Sphere], u: DVec3, v: DVec3) -> Frame {
        let n = u.cross(v);
        let origin = spheres[0].0;
        let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let local = |&(p, r): &Sphere| {
            let d = p - origin;
            let p = DVec3::new(d.dot(u), d.dot(v), d.dot(n));
            (lo, hi) = (lo.min(p - r), hi.max(p + r));
            (p, r)
        };
        let spheres = spheres.iter().map(local).collect();
        Frame { origin, axes: [u, v, n], spheres, mid: (lo + hi) * 0.5 }
    }

    /// Returns the volume of one kind around the spheres, but for rounding.
    fn fit(&self, kind: SweptKind) -> Swept {
        let Frame { origin, axes: [u, v, n], ref spheres, mid } = *self;
        let [(x, half_u), (y, half_v)] = self.core(kind);
        let centre = origin + u * x + v * y + n * mid.z;
        let radius = farthest(spheres, |p| {
            let (dx, dy) = (((p.x - x).abs() - half_u).max(0.0), ((p.y - y).abs() - half_v).max(0.0));
            let dz = p.z - mid.z;
            dx * dx + dy * dy + dz * dz
        });
        Swept { centre, u, v, half: [half_u, half_v], radius }
    }

    /// Returns the middle and half the length of the core of one kind, along its first and second
    /// axis.
    fn core(&self, kind: SweptKind) -> [(f64, f64); 2] {
        let Frame { ref spheres, mid, .. } = *self;
        if kind == SweptKind::Point {
            return [(mid.x, 0.0), (mid.y, 0.0)];
        }
        let is_plane = kind == SweptKind::Rectangle;
        // Squared distance of a sphere from the core's line or plane, as if that had no end.
        let off_core = |p: DVec3| {
            let z = (p.z - mid.z) * (p.z - mid.z);
            if is_plane { z } else { (p.y - mid.y) * (p.y - mid.y) + z }
        };
        // The radius around an endless core.
        let radius = farthest(spheres, off_core);
        let (mut from, mut to) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &(p, r) in spheres {
            // The round end already covers this much beyond the core, so the core can be shorter.
            let room = ((radius - r) * (radius - r) - off_core(p)).max(0.0).sqrt();
            (from, to) = (from.min(p + room), to.max(p - room));
        }
        let extent = |axis: usize| {
            let (from, to) = (from[axis], to[axis]);
            if from < to { ((from + to) * 0.5, (to - from) * 0.5) } else { (mid[axis], 0.0) }
        };
        [extent(0), if is_plane { extent(1) } else { (mid.y, 0.0) }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spheres() -> impl Strategy<Value = Vec<Sphere>> {
        let coordinate = -10.0..10.0;
        prop::collection::vec((prop::array::uniform3(coordinate), 0.0..1.0), 1..40)
            .prop_map(|v| v.into_iter().map(|(p, r)| (DVec3::from(p), r)).collect())
    }

    proptest! {
        #[test]
        fn bounds_hold(spheres in spheres(), q in prop::array::uniform3(-30.0..30.0f64)) {
            let swept = Swept::around(&spheres);
            let q = DVec3::from(q);
            for (p, r) in spheres {
                prop_assert!(swept.lower_bound(q) <= ((q - p).length() - r).max(0.0) + 1e-12);
                prop_assert!(swept.upper_bound(q) >= (q - p).length() + r - 1e-12);
            }
        }
    }

    #[test]
    fn the_best_fit_is_chosen() {
        let ball: Vec<Sphere> = (0..100)
            .map(|i| {
                let (a, z) = (i as f64 * 2.4, i as f64 / 49.5 - 1.0);
                let s = (1.0 - z * z).max(0.0).sqrt();
                (DVec3::new(s * a.cos(), s * a.sin(), z), 0.0)
            })
            .collect();
        assert_eq!(Swept::around(&ball).kind(), SweptKind::Point);
        let rod: Vec<Sphere> = (0..10).map(|i| (DVec3::new(i as f64, 0.0, 0.0), 0.1)).collect();
        assert_eq!(Swept::around(&rod).kind(), SweptKind::Line);
        let plate: Vec<Sphere> =
            (0..100).map(|i| (DVec3::new((i % 10) as f64, (i / 10) as f64, 0.0), 0.01)).collect();
        assert_eq!(Swept::around(&plate).kind(), SweptKind::Rectangle);
    }

    #[test]
    fn axes_are_perpendicular_for_needles_and_segments() {
        let (a, b) = (DVec3::new(0.37, -0.91, 0.22), DVec3::new(-0.55, 0.13, 0.87));
        for off in [0.0, 1e-17, 1e-14, 1e-9, 1e-6] {
            for c in [a, b, a.lerp(b, 0.3)] {
                let swept = Swept::shape_around_triangle([a, b, c + off * DVec3::new(0.3, 1.0, -0.2)]);
                assert!(swept.u.dot(swept.v).abs() < 1e-12, "{off}: {swept:?}");
                assert!((swept.v.length() - 1.0).abs() < 1e-12 && (swept.u.length() - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_triangle_has_no_radius() {
        let corners = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 3.0)];
        let swept = Swept::shape_around_triangle(corners).with_radius_around(&corners.map(|c| (c, 0.0)));
        assert!(swept.radius < 1e-14);
    }
}
