//! Flat-faced solids: box, wedge, needle, L-bracket, fin, and a box with a cavity.

use super::builder::{Builder, Point, reversed};
use super::spheres::{Side, add_sphere};
use crate::mesh::TriMesh;

/// Returns the cube from (-1, -1, -1) to (1, 1, 1).
pub fn cube(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    add_box(&mut b, [-1.0; 3], [1.0; 3]);
    b.finish()
}

/// The radius of the cavity of [`hollow_box`].
pub(super) const CAVITY_RADIUS: f64 = 0.6;

/// Returns the cube of side 2 with a spherical cavity of radius 0.6 about its centre: two closed
/// surfaces, the inner one facing inward.
pub fn hollow_box(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    add_box(&mut b, [-1.0; 3], [1.0; 3]);
    add_sphere(&mut b, [0.0; 3], CAVITY_RADIUS, Side::Inward);
    b.finish()
}

/// Half the width of [`wedge`] at its blunt end; its sharp edge has a dihedral angle of 11.4
/// degrees.
pub(super) const WEDGE_HALF_WIDTH: f64 = 0.2;

/// Returns a wedge of length 2 and depth 2 that ends in a knife edge.
pub fn wedge(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let profile = [[-1.0, -WEDGE_HALF_WIDTH], [1.0, 0.0], [-1.0, WEDGE_HALF_WIDTH]];
    add_prism(&mut b, &profile, -1.0, 1.0);
    b.finish()
}

/// Half the side of the base of [`needle`].
pub(super) const NEEDLE_HALF_SIDE: f64 = 0.05;

/// Returns a four-sided spike, 2 long and 0.1 wide at its base.
pub fn needle(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let s = NEEDLE_HALF_SIDE;
    let base = b.vertices([[-s, -s, 0.0], [s, -s, 0.0], [s, s, 0.0], [-s, s, 0.0]]);
    let tip = b.vertex([0.0, 0.0, 2.0]);
    face(&mut b, &reversed(&base));
    for i in 0..4 {
        face(&mut b, &[base[i], base[(i + 1) % 4], tip]);
    }
    b.finish()
}

/// The thickness of the fin of [`fin`]: below a voxel at resolution 64.
pub(super) const FIN_THICKNESS: f64 = 0.02;

/// Returns a block of 2 x 2 x 0.5 with a thin upright fin on it, 1.6 long, 0.8 high and 0.02 thick.
pub fn fin(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let base = rectangle(&mut b, [1.0, 1.0], -0.5);
    let low = b.outline(&base);
    let high = b.moved(&low, [0.0, 0.0, 0.5]);
    let foot = rectangle(&mut b, [0.8, 0.5 * FIN_THICKNESS], 0.0);
    let foot = b.outline(&foot);
    let top = b.moved(&foot, [0.0, 0.0, 0.8]);
    b.flat(&[&reversed(&low)]);
    b.wall(&low, &high);
    b.flat(&[&high, &reversed(&foot)]);
    b.wall(&foot, &top);
    b.flat(&[&top]);
    b.finish()
}

/// Measures of [`bracket`]: the length of its legs, their thickness, its width, and the radius of
/// its holes.
pub(super) const BRACKET: (f64, f64, f64, f64) = (2.0, 0.3, 1.2, 0.25);

/// Returns an L-bracket: two legs 2 long, 0.3 thick and 1.2 wide, each with a hole of radius 0.25
/// through it.
pub fn bracket(detail: u32) -> TriMesh {
    let (leg, t, width, radius) = BRACKET;
    let mut b = Builder::new(detail);
    let profile = [[0.0, 0.0], [leg, 0.0], [leg, t], [t, t], [t, leg], [0.0, leg]];
    let near = b.vertices(profile.map(|[x, y]| [x, y, 0.0]));
    let far = b.vertices(profile.map(|[x, y]| [x, y, width]));
    face(&mut b, &reversed(&near));
    face(&mut b, &far);
    let middle = (0.5 * (leg + t), 0.5 * width);
    // Circles about the axis of each hole, counter-clockwise about +y and +x, at the outer and
    // inner side.
    let [down, up] = [0.0, t].map(|y| b.circle([middle.0, y, middle.1], 2, 0, radius));
    let [left, right] = [0.0, t].map(|x| b.circle([x, middle.0, middle.1], 1, 2, radius));
    let holes = [Some(&down), None, Some(&up), Some(&right), None, Some(&left)];
    for (i, hole) in holes.into_iter().enumerate() {
        let j = (i + 1) % 6;
        let outer = b.outline(&[near[i], near[j], far[j], far[i]]);
        match hole {
            // Faces 0 and 5 look down the axes, faces 2 and 3 up.
            Some(hole) if i == 0 || i == 5 => b.flat(&[&outer, hole]),
            Some(hole) => b.flat(&[&outer, &reversed(hole)]),
            None => b.flat(&[&outer]),
        }
    }
    // Seen from inside the hole.
    b.wall(&up, &down);
    b.wall(&right, &left);
    b.finish()
}

/// Four corners at height `z`, counter-clockwise from above.
fn rectangle(b: &mut Builder, half: [f64; 2], z: f64) -> Vec<u32> {
    let [x, y] = half;
    b.vertices([[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]])
}

fn face(b: &mut Builder, corners: &[u32]) {
    let around = b.outline(corners);
    b.flat(&[&around]);
}

/// A prism over a counter-clockwise profile in the plane of x and y.
fn add_prism(b: &mut Builder, profile: &[[f64; 2]], z0: f64, z1: f64) {
    let near = b.vertices(profile.iter().map(|&[x, y]| [x, y, z0]));
    let far = b.vertices(profile.iter().map(|&[x, y]| [x, y, z1]));
    face(b, &reversed(&near));
    face(b, &far);
    for i in 0..profile.len() {
        let j = (i + 1) % profile.len();
        face(b, &[near[i], near[j], far[j], far[i]]);
    }
}

/// An axis-aligned box with evenly divided faces.
fn add_box(b: &mut Builder, lo: Point, hi: Point) {
    let corner = |b: &mut Builder, n: usize| {
        let p = std::array::from_fn(|a| if n >> a & 1 == 1 { hi[a] } else { lo[a] });
        b.vertex(p)
    };
    let c: Vec<u32> = (0..8).map(|n| corner(b, n)).collect();
    // Corner n has bit a set where its coordinate a is the larger one. Low left, low right, high
    // left, high right, seen from outside.
    for [l, r, hl, hr] in [[0, 4, 2, 6], [5, 1, 7, 3], [1, 0, 3, 2], [4, 5, 6, 7], [0, 1, 4, 5], [3, 2, 7, 6]]
    {
        let low = b.walk(c[l], c[r]);
        let high = b.walk(c[hl], c[hr]);
        let left = b.walk(c[l], c[hl]);
        let right = b.walk(c[r], c[hr]);
        b.ruled(&low, &high, &left, &right);
    }
}
