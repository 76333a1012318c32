//! Cylinder and tori.

use super::builder::{Builder, Point, reversed};
use crate::mesh::TriMesh;
use std::f64::consts::TAU;

/// Returns a cylinder about the z axis, of radius 1 and height 2.
pub fn cylinder(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let low = b.circle([0.0, 0.0, -1.0], 0, 1, 1.0);
    let high = b.moved(&low, [0.0, 0.0, 2.0]);
    b.flat(&[&reversed(&low)]);
    b.wall(&low, &high);
    b.flat(&[&high]);
    b.finish()
}

/// Major and minor radius of [`torus`].
pub(super) const TORUS: (f64, f64) = (1.0, 0.4);

/// Returns a torus about the z axis with radii 1 and 0.4.
pub fn torus(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    add_torus(&mut b, TORUS, |p| p);
    b.finish()
}

/// Major and minor radius of each of the [`linked_tori`].
pub(super) const LINK: (f64, f64) = (1.0, 0.25);

/// Two tori of radii 1 and 0.25, linked like the members of a chain without touching.
pub fn linked_tori(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    add_torus(&mut b, LINK, |p| p);
    add_torus(&mut b, LINK, |[x, y, z]| [x + 1.0, -z, y]);
    b.finish()
}

fn add_torus(b: &mut Builder, (major, minor): (f64, f64), place: impl Fn(Point) -> Point) {
    let (n, m) = (b.divisions(TAU * major, 8), b.divisions(TAU * minor, 6));
    let ring = |i: usize| {
        let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
        (0..=m).map(move |j| {
            let (s, c) = (TAU * (j % m) as f64 / m as f64).sin_cos();
            let r = major + minor * c;
            [r * cos, r * sin, minor * s]
        })
    };
    let rings: Vec<Vec<u32>> = (0..n)
        .map(|i| {
            let mut row = b.vertices(ring(i).take(m).map(&place));
            row.push(row[0]);
            row
        })
        .collect();
    for i in 0..n {
        b.strip(&rings[(i + 1) % n], &rings[i]);
    }
}
