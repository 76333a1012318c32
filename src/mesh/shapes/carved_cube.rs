//! The carved cube: flat faces, spherical and cylindrical bites, sharp creases between them.

use super::builder::{Builder, Point, reversed};
use crate::mesh::TriMesh;
use std::f64::consts::{FRAC_PI_2, PI};

/// Radius of the sphere that bites off the corner (1, 1, 1).
const BITE: f64 = 0.8;
/// Radius of the cylinder that bites off the edge at x = y = -1.
const GROOVE: f64 = 0.6;
/// Radius of the bore along the z axis.
const BORE: f64 = 0.35;
/// The dent in the face x = 1: the centre and radius of its rim, and its depth.
const DENT: (Point, f64, f64) = ([1.0, -0.35, -0.35], 0.45, 0.3);

/// The volume that the mesh approaches with growing detail.
pub(super) const VOLUME: f64 = {
    let (_, rim, depth) = DENT;
    let cap = PI * depth * (3.0 * rim * rim + depth * depth) / 6.0;
    8.0 - PI * BITE * BITE * BITE / 6.0 - 0.5 * PI * GROOVE * GROOVE - 2.0 * PI * BORE * BORE - cap
};

/// Returns the cube of side 2 about the origin, carved in four places that keep clear of one
/// another:
///
/// ```text
///      z = 1 seen from above                 x = 1 seen from outside
///   +-------------___                     +----------___
///   |            /    sphere about        |         /     the same sphere
///   |     __    |     (1, 1, 1)           |        |
///   |    /  \    \___                     |   __    \___
///   |    \__/        |                    |  /  \       |
///   |_    bore       |                    |  \__/ dent  |
///     \              |                    |             |
///      | groove      |                    |             |
///      +-------------+                    +-------------+
/// ```
pub fn carved_cube(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let c = Corners::new(&mut b);
    let n = b.divisions(FRAC_PI_2 * BITE, 4);
    // The three rims of the corner bite, each from one axis to the next.
    for a in 0..3 {
        b.curve(c.bite[a], c.bite[(a + 1) % 3], (1..n).map(|i| bite_point(n, a, [n - i, i])));
    }
    let m = b.divisions(FRAC_PI_2 * GROOVE, 4);
    for (k, z) in [-1.0, 1.0].into_iter().enumerate() {
        b.curve(c.groove_x[k], c.groove_y[k], (1..m).map(|i| groove_point(m, i, z)));
    }
    let bore = [-1.0, 1.0].map(|z| b.circle([0.0, 0.0, z], 0, 1, BORE));
    let (centre, rim, _) = DENT;
    let dent = b.circle(centre, 1, 2, rim);

    let [bx, by, bz] = c.bite;
    let ([gx0, gx1], [gy0, gy1]) = (c.groove_x, c.groove_y);
    let top = b.outline(&[gx1, c.of(1, -1, 1), by, bx, c.of(-1, 1, 1), gy1]);
    let bottom = b.outline(&[gx0, gy0, c.of(-1, 1, -1), c.of(1, 1, -1), c.of(1, -1, -1)]);
    let right = b.outline(&[c.of(1, -1, -1), c.of(1, 1, -1), bz, by, c.of(1, -1, 1)]);
    let left = b.outline(&[gy0, gy1, c.of(-1, 1, 1), c.of(-1, 1, -1)]);
    let back = b.outline(&[c.of(-1, 1, -1), c.of(-1, 1, 1), bx, bz, c.of(1, 1, -1)]);
    let front = b.outline(&[gx0, c.of(1, -1, -1), c.of(1, -1, 1), gx1]);
    b.flat(&[&top, &reversed(&bore[1])]);
    b.flat(&[&bottom, &bore[0]]);
    b.flat(&[&right, &reversed(&dent)]);
    for outline in [&left, &back, &front] {
        b.flat(&[outline]);
    }
    b.wall(&bore[1], &bore[0]);
    add_groove(&mut b, &c);
    add_dent(&mut b, &dent);
    add_bite(&mut b, &c, n);
    b.finish()
}

/// The points where three or more patches meet.
struct Corners {
    cube: Vec<u32>,
    /// The ends of the corner bite on the cube's edges along x, y, z.
    bite: [u32; 3],
    /// The ends of the groove on the faces y = -1 and x = -1, at z = -1 and z = 1.
    groove_x: [u32; 2],
    groove_y: [u32; 2],
}

impl Corners {
    fn new(b: &mut Builder) -> Self {
        let bite = [0, 1, 2].map(|a| {
            let mut p = [1.0; 3];
            p[a] -= BITE;
            b.vertex(p)
        });
        let groove_x = [-1.0, 1.0].map(|z| b.vertex([GROOVE - 1.0, -1.0, z]));
        let groove_y = [-1.0, 1.0].map(|z| b.vertex([-1.0, GROOVE - 1.0, z]));
        // The five corners that no bite removes.
        let signs = [[1, -1, -1], [1, 1, -1], [-1, 1, -1], [1, -1, 1], [-1, 1, 1]];
        let cube = b.vertices(signs.map(|s| s.map(f64::from)));
        Corners { cube, bite, groove_x, groove_y }
    }

    /// Returns the corner of the cube with these signs.
    fn of(&self, x: i32, y: i32, z: i32) -> u32 {
        match (x, y, z) {
            (1, -1, -1) => self.cube[0],
            (1, 1, -1) => self.cube[1],
            (-1, 1, -1) => self.cube[2],
            (1, -1, 1) => self.cube[3],
            (-1, 1, 1) => self.cube[4],
            _ => unreachable!("({x}, {y}, {z}) is carved away"),
        }
    }
}

/// Returns the unit direction whose components have the ratio of the sines of `weights` of `n`
/// right angles. With one weight zero it divides the quarter circle between the other two axes
/// evenly.
fn octant(n: usize, weights: [usize; 3]) -> Point {
    let d = weights.map(|w| (FRAC_PI_2 * w as f64 / n as f64).sin());
    let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    d.map(|x| x / length)
}

/// Returns a point on the corner bite's rim between axis `a` and the next.
fn bite_point(n: usize, a: usize, [first, second]: [usize; 2]) -> Point {
    let mut weights = [0; 3];
    weights[a] = first;
    weights[(a + 1) % 3] = second;
    octant(n, weights).map(|d| 1.0 - BITE * d)
}

fn groove_point(m: usize, i: usize, z: f64) -> Point {
    let [x, y, _] = octant(m, [m - i, i, 0]);
    [GROOVE * x - 1.0, GROOVE * y - 1.0, z]
}

fn add_groove(b: &mut Builder, c: &Corners) {
    let low = b.walk(c.groove_y[0], c.groove_x[0]);
    let high = b.walk(c.groove_y[1], c.groove_x[1]);
    let left = b.walk(c.groove_y[0], c.groove_y[1]);
    let right = b.walk(c.groove_x[0], c.groove_x[1]);
    b.ruled(&low, &high, &left, &right);
}

fn add_dent(b: &mut Builder, rim: &[u32]) {
    let (centre, radius, depth) = DENT;
    let sphere = (radius * radius + depth * depth) / (2.0 * depth);
    b.lifted(&[rim], 0, |[_, y, z]| {
        let off = (y - centre[1]).powi(2) + (z - centre[2]).powi(2);
        [centre[0] + (sphere - depth) - (sphere * sphere - off).sqrt(), y, z]
    });
}

/// The corner bite: an octant of a sphere, divided like a triangle.
fn add_bite(b: &mut Builder, c: &Corners, n: usize) {
    let [bx, by, bz] = c.bite;
    let (xy, yz, zx) = (b.walk(bx, by), b.walk(by, bz), b.walk(bz, bx));
    // Row i has weight i on z; it runs from the rim in the plane of x and z to the one in that of y
    // and z.
    let mut below = xy;
    for i in 1..=n {
        let mut row = vec![zx[n - i]];
        for j in 1..n - i {
            row.push(b.vertex(octant(n, [n - i - j, j, i]).map(|d| 1.0 - BITE * d)));
        }
        if i < n {
            row.push(yz[i]);
        }
        for j in 0..row.len() {
            b.triangle(below[j], below[j + 1], row[j]);
            if j + 1 < row.len() {
                b.triangle(row[j], below[j + 1], row[j + 1]);
            }
        }
        below = row;
    }
}
