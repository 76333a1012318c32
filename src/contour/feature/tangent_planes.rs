//! Tangent planes of the surface: those at the crossings of a sheet, clustered by the faces of a
//! crease, and the points in which planes meet.

use crate::geom::quadric::Qef;
use glam::DVec3;

/// The cosine above which the normals of two crossings belong to one face (18 degrees).
///
/// A blunter crease that is cut off by a whole voxel is off by less than 0.08 voxels.
pub const SAME_FACE: f64 = 0.95;

/// The square of the sine between two planes below which they meet nowhere (2 degrees).
const PARALLEL: f64 = 1e-3;

/// A tangent plane near a feature.
#[derive(Clone, Copy, Debug, Default)]
pub struct TangentPlane {
    /// The point of contact, or a point close to it.
    pub anchor: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// The triangle whose surface the plane touches.
    pub triangle: u32,
}

/// The most planes that meet in a point in general.
pub const MAX_PLANES: usize = 3;

/// The planes that meet in a feature: two in a crease, three in a corner.
#[derive(Clone, Copy, Debug)]
pub struct MeetingPlanes {
    planes: [TangentPlane; MAX_PLANES],
    len: usize,
}

impl MeetingPlanes {
    /// Returns the planes.
    pub fn slice(&self) -> &[TangentPlane] {
        &self.planes[..self.len]
    }

    /// Returns the planes, to be changed.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, TangentPlane> {
        self.planes[..self.len].iter_mut()
    }

    /// Returns the normals of the planes.
    pub fn normals(&self) -> Normals {
        let mut normals = Normals::default();
        for (to, plane) in normals.iter_mut().zip(self.slice()) {
            *to = plane.normal.to_array().map(|x| x as f32);
        }
        normals
    }

    /// Adds a plane; `None` when there are three already.
    pub fn with(mut self, plane: TangentPlane) -> Option<MeetingPlanes> {
        *self.planes.get_mut(self.len)? = plane;
        self.len += 1;
        Some(self)
    }

    /// Returns the point nearest to `base` in which the planes meet; `None` when they are parallel.
    pub fn meet(&self, base: DVec3) -> Option<DVec3> {
        if self.len == 3 {
            // Three planes may have a line in common, or nearly.
            let mut qef = Qef::default();
            for plane in self.slice() {
                qef.add(plane.anchor, plane.normal);
            }
            return Some(qef.minimiser_near(base).point);
        }
        let [a, b] = [self.planes[0], self.planes[1]];
        let height = |p: &TangentPlane| p.normal.dot(p.anchor - base);
        let (ha, hb, cosine) = (height(&a), height(&b), a.normal.dot(b.normal));
        let det = 1.0 - cosine * cosine;
        if det < PARALLEL {
            return None;
        }
        let point = base + (ha - cosine * hb) / det * a.normal;
        Some(point + (hb - cosine * ha) / det * b.normal)
    }
}

/// The unit normals of the planes of a feature, zero beyond the last one.
pub type Normals = [[f32; 3]; MAX_PLANES];

/// The Hermite data of a sheet: points in the cell's coordinates, with unit normals and triangles.
#[derive(Clone, Copy, Debug, Default)]
pub struct HermiteSamples {
    all: [TangentPlane; 12],
    len: usize,
}

impl HermiteSamples {
    /// Adds a sample, of at most twelve, if its normal is a unit vector.
    #[inline]
    pub fn push(&mut self, anchor: DVec3, normal: DVec3, triangle: u32) {
        // A normal that is not a number has no length of one.
        if (normal.dot(normal) - 1.0).abs() < 1e-3 {
            self.all[self.len] = TangentPlane { anchor, normal, triangle };
            self.len += 1;
        }
    }

    fn slice(&self) -> &[TangentPlane] {
        &self.all[..self.len]
    }

    /// Whether the samples lie on more than one face of a crease.
    pub fn see_several_faces(&self) -> bool {
        self.cluster_by_normal(DVec3::ZERO).len >= 2
    }

    /// Returns the height of `point` above a smooth surface through the samples, in voxels, and the
    /// surface's normal there.
    ///
    /// The height follows by the trapezoidal rule along the ways from the samples, with the mean
    /// normal at the end. It is exact for quadratic functions, where the tangent planes themselves
    /// are off by their curvature.
    pub fn height(&self, point: DVec3) -> (f64, DVec3) {
        let sum = self.slice().iter().fold(DVec3::ZERO, |sum, plane| sum + plane.normal);
        let length = sum.length();
        if length < f64::MIN_POSITIVE {
            return (0.0, sum);
        }
        let mean = sum / length;
        let rise = |p: &TangentPlane| (p.normal + mean).dot(point - p.anchor) / 2.0;
        let rises = self.slice().iter().map(rise);
        (rises.sum::<f64>() / self.len as f64, mean)
    }

    /// Returns the distance from `point` to the farthest of the tangent planes, in voxels.
    pub fn disagreement(&self, point: DVec3) -> f64 {
        let planes = self.slice().iter();
        planes.map(|p| p.normal.dot(point - p.anchor).abs()).fold(0.0, f64::max)
    }

    /// Clusters the samples by the faces of a crease or corner, and returns one tangent plane for
    /// each face: that of the sample nearest to `near`.
    ///
    /// There are fewer than two planes when the samples lie on one face only.
    pub fn cluster_by_normal(&self, near: DVec3) -> MeetingPlanes {
        let samples = self.slice();
        let mut faces = MeetingPlanes { planes: [TangentPlane::default(); MAX_PLANES], len: 0 };
        let Some(&TangentPlane { normal: first, .. }) = samples.first() else { return faces };
        let farthest = |from: &[DVec3]| {
            let nearest_cosine = |n: DVec3| from.iter().map(|f| f.dot(n)).fold(f64::NEG_INFINITY, f64::max);
            let all = samples.iter().map(|p| (nearest_cosine(p.normal), p.normal));
            let least = all.min_by(|a, b| a.0.total_cmp(&b.0));
            least.filter(|(cosine, _)| *cosine < SAME_FACE).map(|(_, n)| n)
        };
        let Some(a) = farthest(&[first]) else { return faces };
        let Some(b) = farthest(&[a]) else { return faces };
        let directions = [a, b, farthest(&[a, b]).unwrap_or(a)];
        let count = if directions[2] == a { 2 } else { 3 };
        for (n, &direction) in directions[..count].iter().enumerate() {
            let belongs = |normal: DVec3| {
                directions[..count]
                    .iter()
                    .enumerate()
                    .all(|(m, other)| m == n || other.dot(normal) < direction.dot(normal))
            };
            let own = samples.iter().filter(|p| belongs(p.normal));
            let distance2 = |p: &TangentPlane| p.anchor.distance_squared(near);
            if let Some(&plane) = own.min_by(|p, q| distance2(p).total_cmp(&distance2(q))) {
                faces = faces.with(plane).expect("at most three");
            }
        }
        faces
    }
}
