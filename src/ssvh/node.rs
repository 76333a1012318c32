//! A node: eight swept sphere volumes side by side, so that one pass bounds all eight.

use crate::geom::simd::{F32s, Vec3F32s};
use crate::geom::swept::{Sphere, Swept};
use glam::{DVec3, Vec3};
use pulp::Simd;

/// The number of children of a node.
pub(super) const WIDTH: usize = 8;

/// The kind of a node's children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    /// `children` are node numbers.
    Inner,
    /// `children` are slots in the hierarchy's order of triangles.
    Leaf,
}

/// Eight volumes as a structure of arrays. Coordinates are relative to the hierarchy's centre.
/// Lanes from `count` on are empty.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    centre: [[f32; WIDTH]; 3],
    u: [[f32; WIDTH]; 3],
    v: [[f32; WIDTH]; 3],
    half: [[f32; WIDTH]; 2],
    radius: [f32; WIDTH],
    pub(super) children: [u32; WIDTH],
    pub(super) count: u32,
    pub(super) level: Level,
}

impl Node {
    pub(super) const EMPTY: Node = Node {
        centre: [[0.0; WIDTH]; 3],
        u: [[0.0; WIDTH]; 3],
        v: [[0.0; WIDTH]; 3],
        half: [[0.0; WIDTH]; 2],
        // Farther than anything: an empty lane is never looked at.
        radius: [f32::NEG_INFINITY; WIDTH],
        children: [u32::MAX; WIDTH],
        count: 0,
        level: Level::Leaf,
    };

    /// Appends a child whose volume is `swept`, rounded to f32 and widened to enclose `spheres`
    /// again; the radius that it has is not needed for that. Returns the volume as it is stored.
    /// Coordinates are relative to the hierarchy's centre.
    pub(super) fn push(&mut self, child: u32, swept: &Swept, spheres: &[Sphere]) -> Swept {
        let lane = self.count as usize;
        let rounded = Swept {
            centre: swept.centre.as_vec3().as_dvec3(),
            u: swept.u.as_vec3().as_dvec3(),
            v: swept.v.as_vec3().as_dvec3(),
            half: swept.half.map(|x| f64::from(x as f32)),
            radius: 0.0,
        }
        .with_radius_around(spheres);
        let radius = (rounded.radius as f32).next_up();
        for axis in 0..3 {
            self.centre[axis][lane] = rounded.centre[axis] as f32;
            self.u[axis][lane] = rounded.u[axis] as f32;
            self.v[axis][lane] = rounded.v[axis] as f32;
        }
        self.half[0][lane] = rounded.half[0] as f32;
        self.half[1][lane] = rounded.half[1] as f32;
        self.radius[lane] = radius;
        self.children[lane] = child;
        self.count += 1;
        Swept { radius: f64::from(radius), ..rounded }
    }

    /// Returns the volume in `lane`, relative to the hierarchy's centre.
    pub(super) fn swept(&self, lane: usize) -> Swept {
        let vector =
            |a: &[[f32; WIDTH]; 3]| DVec3::from_array([0, 1, 2].map(|axis| f64::from(a[axis][lane])));
        Swept {
            centre: vector(&self.centre),
            u: vector(&self.u),
            v: vector(&self.v),
            half: [f64::from(self.half[0][lane]), f64::from(self.half[1][lane])],
            radius: f64::from(self.radius[lane]),
        }
    }

    /// Returns the distance of `q`, relative to the hierarchy's centre, from the volume in each
    /// lane: negative inside, infinite if empty, exact but for rounding of a few 2^-24 of the
    /// distances involved.
    #[inline(always)]
    pub(super) fn distances<S: Simd>(&self, simd: S, q: Vec3) -> [f32; WIDTH] {
        let q = Vec3F32s::splat(simd, q.to_array());
        let mut distances = [0.0; WIDTH];
        for vector in 0..WIDTH / F32s::<S>::COUNT {
            let (u, v) = (Vec3F32s::load(simd, &self.u, vector), Vec3F32s::load(simd, &self.v, vector));
            let [half_u, half_v] = &self.half;
            let half = [F32s::load(simd, half_u, vector), F32s::load(simd, half_v, vector)];
            let from = q - Vec3F32s::load(simd, &self.centre, vector);
            let distance = core_distance(simd, from, u, v, half);
            (distance - F32s::load(simd, &self.radius, vector)).store(&mut distances, vector);
        }
        distances
    }

    /// Whether one of eight points is as near to the volume in `lane` as its limit. The distance is
    /// that of [`distances`](Self::distances), which has one point and eight volumes.
    #[inline(always)]
    pub(super) fn is_near<S: Simd>(
        &self,
        simd: S,
        lane: usize,
        points: &[[f32; 8]; 3],
        limits: &[f32; 8],
    ) -> bool {
        let centre =
            Vec3F32s::splat(simd, [self.centre[0][lane], self.centre[1][lane], self.centre[2][lane]]);
        let u = Vec3F32s::splat(simd, [self.u[0][lane], self.u[1][lane], self.u[2][lane]]);
        let v = Vec3F32s::splat(simd, [self.v[0][lane], self.v[1][lane], self.v[2][lane]]);
        let half = [F32s::splat(simd, self.half[0][lane]), F32s::splat(simd, self.half[1][lane])];
        let radius = F32s::splat(simd, self.radius[lane]);
        let mut any = false;
        for vector in 0..8 / F32s::<S>::COUNT {
            let from = Vec3F32s::load(simd, points, vector) - centre;
            let distance = core_distance(simd, from, u, v, half) - radius;
            any |= distance.at_most(F32s::load(simd, limits, vector)).any();
        }
        any
    }
}

/// Returns the distances of points from a rectangle with the axes `u` and `v`. `from` are the
/// points relative to its centre.
#[inline(always)]
fn core_distance<S: Simd>(
    simd: S,
    from: Vec3F32s<S>,
    u: Vec3F32s<S>,
    v: Vec3F32s<S>,
    [half_u, half_v]: [F32s<S>; 2],
) -> F32s<S> {
    let zero = F32s::splat(simd, 0.0);
    let beyond_u = (from.dot_plus(u, zero).abs() - half_u).max(zero);
    let beyond_v = (from.dot_plus(v, zero).abs() - half_v).max(zero);
    let height = from.dot_plus(u.cross(v), zero);
    beyond_u.times_plus(beyond_u, beyond_v.times_plus(beyond_v, height * height)).sqrt()
}
