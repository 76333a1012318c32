//! Planes of the surface: those that the crossings of a sheet see, by the sides of a crease that they are on, and where
//! planes meet.

use crate::geom::quadric::{Qef, along, distance2, dot};

type Point = [f64; 3];

/// Crossings whose normals differ by less than this belong to one side of a crease (cosine of 18 degrees). A
/// blunter crease that is cut off by a whole voxel is off by less than 0.08 voxels.
pub const ONE_SIDE: f64 = 0.95;

/// Planes meet nowhere when the square of the sine between them is below this: 2 degrees.
const PARALLEL: f64 = 1e-3;

/// A plane near a feature.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plane {
    /// Where it touches the surface or close to it.
    pub anchor: Point,
    /// Unit normal.
    pub normal: Point,
    /// The piece of the surface that it belongs to.
    pub piece: u32,
}

/// The most planes that meet in a point in general.
pub const MAX_PLANES: usize = 3;

/// The planes that meet in a feature.
#[derive(Clone, Copy, Debug)]
pub struct Planes {
    planes: [Plane; MAX_PLANES],
    len: usize,
}

impl Planes {
    /// The planes.
    pub fn slice(&self) -> &[Plane] {
        &self.planes[..self.len]
    }

    /// The planes, to be changed.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, Plane> {
        self.planes[..self.len].iter_mut()
    }

    /// Their normals.
    pub fn normals(&self) -> Normals {
        let mut normals = Normals::default();
        for (to, plane) in normals.iter_mut().zip(self.slice()) {
            *to = plane.normal.map(|x| x as f32);
        }
        normals
    }

    /// With one more; `None` when there are three already.
    pub fn with(mut self, plane: Plane) -> Option<Planes> {
        *self.planes.get_mut(self.len)? = plane;
        self.len += 1;
        Some(self)
    }

    /// The point nearest to `base` in which the planes meet; `None` when they are parallel.
    pub fn meet(&self, base: Point) -> Option<Point> {
        if self.len == 3 {
            // Three planes may have a line in common, or nearly.
            let mut qef = Qef::default();
            for plane in self.slice() {
                qef.add(plane.anchor, plane.normal);
            }
            return Some(qef.minimiser_near(base).point);
        }
        let [a, b] = [self.planes[0], self.planes[1]];
        let height = |p: &Plane| dot(p.normal, along(p.anchor, -1.0, base));
        let (ha, hb, cosine) = (height(&a), height(&b), dot(a.normal, b.normal));
        let det = 1.0 - cosine * cosine;
        if det < PARALLEL {
            return None;
        }
        let point = along(base, (ha - cosine * hb) / det, a.normal);
        Some(along(point, (hb - cosine * ha) / det, b.normal))
    }
}

/// The unit normals of the sides of a feature, zero beyond the last one.
pub type Normals = [[f32; 3]; MAX_PLANES];

/// The samples of a sheet: points in the cell's coordinates, with unit normals and pieces.
#[derive(Clone, Copy, Debug, Default)]
pub struct Samples {
    all: [Plane; 12],
    len: usize,
}

impl Samples {
    /// Adds a sample, at most twelve, if its normal is one.
    #[inline]
    pub fn push(&mut self, anchor: Point, normal: Point, piece: u32) {
        // What is not a number has no length of one.
        if (dot(normal, normal) - 1.0).abs() < 1e-3 {
            self.all[self.len] = Plane { anchor, normal, piece };
            self.len += 1;
        }
    }

    fn slice(&self) -> &[Plane] {
        &self.all[..self.len]
    }

    /// Whether they see more than one side of a crease.
    pub fn see_several_sides(&self) -> bool {
        sides(self, [0.0; 3]).len >= 2
    }

    /// How high `point` is above a smooth surface through the samples, and the surface's normal there. By the
    /// trapezoidal rule along the ways from the samples, with the mean normal at the end: exact for quadratic
    /// functions, where the tangent planes themselves are off by their curvature.
    pub fn height(&self, point: Point) -> (f64, Point) {
        let sum = self.slice().iter().fold([0.0; 3], |sum, plane| along(sum, 1.0, plane.normal));
        let length = dot(sum, sum).sqrt();
        if length < f64::MIN_POSITIVE {
            return (0.0, sum);
        }
        let mean = sum.map(|x| x / length);
        let rise = |p: &Plane| dot(along(p.normal, 1.0, mean), along(point, -1.0, p.anchor)) / 2.0;
        let rises = self.slice().iter().map(rise);
        (rises.sum::<f64>() / self.len as f64, mean)
    }

    /// How far the farthest of their planes is from `point`.
    pub fn disagreement(&self, point: Point) -> f64 {
        let planes = self.slice().iter();
        planes.map(|p| dot(p.normal, along(point, -1.0, p.anchor)).abs()).fold(0.0, f64::max)
    }
}

/// The sides of a crease or corner that the samples see: one sample for each, the one nearest to `near`. Fewer
/// than two when the samples see one side only.
pub fn sides(samples: &Samples, near: Point) -> Planes {
    let samples = samples.slice();
    let mut sides = Planes { planes: [Plane::default(); MAX_PLANES], len: 0 };
    let Some(&Plane { normal: first, .. }) = samples.first() else { return sides };
    let farthest = |from: &[Point]| {
        let nearest_cosine = |n: Point| from.iter().map(|&f| dot(f, n)).fold(f64::NEG_INFINITY, f64::max);
        let all = samples.iter().map(|p| (nearest_cosine(p.normal), p.normal));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(cosine, _)| *cosine < ONE_SIDE).map(|(_, n)| n)
    };
    let Some(a) = farthest(&[first]) else { return sides };
    let Some(b) = farthest(&[a]) else { return sides };
    let directions = [a, b, farthest(&[a, b]).unwrap_or(a)];
    let count = if directions[2] == a { 2 } else { 3 };
    for (n, &direction) in directions[..count].iter().enumerate() {
        let belongs = |normal: Point| {
            directions[..count]
                .iter()
                .enumerate()
                .all(|(m, &other)| m == n || dot(other, normal) < dot(direction, normal))
        };
        let own = samples.iter().filter(|p| belongs(p.normal));
        let nearest = own.min_by(|p, q| distance2(p.anchor, near).total_cmp(&distance2(q.anchor, near)));
        if let Some(&plane) = nearest {
            sides = sides.with(plane).expect("at most three");
        }
    }
    sides
}
