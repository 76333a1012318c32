//! A node: eight swept sphere volumes side by side, so that one pass bounds all eight.

use crate::geom::swept::{Sphere, Swept};
use glam::{DVec3, Vec3};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// What the slots of a node stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Level {
    /// `children` are node numbers.
    Inner,
    /// `children` are positions in the hierarchy's order of triangles.
    Leaf,
}

/// Eight volumes as structure of arrays, coordinates relative to the hierarchy's centre. Slots from
/// `count` on are empty.
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
        // Farther than anything: an empty slot is never looked at.
        radius: [f32::NEG_INFINITY; WIDTH],
        children: [u32::MAX; WIDTH],
        count: 0,
        level: Level::Leaf,
    };

    /// Appends a child whose volume is `swept`, rounded to f32 and widened to enclose `spheres` again.
    /// Returns the volume as it is stored. Coordinates are relative to the hierarchy's centre.
    pub(super) fn push(&mut self, child: u32, swept: &Swept, spheres: &[Sphere]) -> Swept {
        let slot = self.count as usize;
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
            self.centre[axis][slot] = rounded.centre[axis] as f32;
            self.u[axis][slot] = rounded.u[axis] as f32;
            self.v[axis][slot] = rounded.v[axis] as f32;
        }
        self.half[0][slot] = rounded.half[0] as f32;
        self.half[1][slot] = rounded.half[1] as f32;
        self.radius[slot] = radius;
        self.children[slot] = child;
        self.count += 1;
        Swept { radius: f64::from(radius), ..rounded }
    }

    /// The volume in `slot`, relative to the hierarchy's centre.
    pub(super) fn swept(&self, slot: usize) -> Swept {
        let vector =
            |a: &[[f32; WIDTH]; 3]| DVec3::from_array([0, 1, 2].map(|axis| f64::from(a[axis][slot])));
        Swept {
            centre: vector(&self.centre),
            u: vector(&self.u),
            v: vector(&self.v),
            half: [f64::from(self.half[0][slot]), f64::from(self.half[1][slot])],
            radius: f64::from(self.radius[slot]),
        }
    }

    /// Per slot the distance of `q` (relative to the hierarchy's centre) from the volume, negative
    /// inside, exact but for rounding of a few 2^-24 of the distances involved; infinite if empty.
    #[inline(always)]
    pub(super) fn distances(&self, q: Vec3) -> [f32; WIDTH] {
        let mut out = [0.0; WIDTH];
        #[allow(clippy::needless_range_loop, reason = "a slot runs through several arrays in step")]
        for i in 0..WIDTH {
            let (dx, dy, dz) = (q.x - self.centre[0][i], q.y - self.centre[1][i], q.z - self.centre[2][i]);
            let (ux, uy, uz) = (self.u[0][i], self.u[1][i], self.u[2][i]);
            let (vx, vy, vz) = (self.v[0][i], self.v[1][i], self.v[2][i]);
            let along_u = dx * ux + dy * uy + dz * uz;
            let along_v = dx * vx + dy * vy + dz * vz;
            let (nx, ny, nz) = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
            let height = dx * nx + dy * ny + dz * nz;
            let beyond_u = (along_u.abs() - self.half[0][i]).max(0.0);
            let beyond_v = (along_v.abs() - self.half[1][i]).max(0.0);
            out[i] = (beyond_u * beyond_u + beyond_v * beyond_v + height * height).sqrt() - self.radius[i];
        }
        out
    }

    /// The distances of eight points from the volume in `slot`, as [`distances`](Self::distances) gives for
    /// one point from eight volumes. `x`, `y` and `z` are the points' coordinates.
    #[inline(always)]
    pub(super) fn distances_from(&self, slot: usize, points: &[[f32; 8]; 3]) -> [f32; 8] {
        let at = |a: &[[f32; WIDTH]; 3]| Vec3::new(a[0][slot], a[1][slot], a[2][slot]);
        let (centre, u, v) = (at(&self.centre), at(&self.u), at(&self.v));
        let n = u.cross(v);
        let (half_u, half_v, radius) = (self.half[0][slot], self.half[1][slot], self.radius[slot]);
        let mut out = [0.0; 8];
        for i in 0..8 {
            let (dx, dy, dz) = (points[0][i] - centre.x, points[1][i] - centre.y, points[2][i] - centre.z);
            let beyond_u = ((dx * u.x + dy * u.y + dz * u.z).abs() - half_u).max(0.0);
            let beyond_v = ((dx * v.x + dy * v.y + dz * v.z).abs() - half_v).max(0.0);
            let height = dx * n.x + dy * n.y + dz * n.z;
            out[i] = (beyond_u * beyond_u + beyond_v * beyond_v + height * height).sqrt() - radius;
        }
        out
    }
}
