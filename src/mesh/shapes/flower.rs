//! The flower: a star-shaped lens with petals, concave creases between them and a sharp rim.

use super::builder::{Builder, Point, mix};
use crate::mesh::TriMesh;
use std::f64::consts::{PI, TAU};

/// Number of petals.
const PETALS: usize = 6;
/// Distance of the notches between petals from the centre, and how far the petals reach beyond.
const OUTLINE: (f64, f64) = (0.8, 0.6);
/// Height of the upper side and depth of the lower one at the centre.
const HEIGHT: (f64, f64) = (0.5, 0.25);

/// The volume that the mesh approaches with growing detail: the outline's area, times the mean
/// height of a paraboloid over it.
pub(super) const VOLUME: f64 = {
    let (a, b) = OUTLINE;
    let area = PI * a * a + 4.0 * a * b + 0.5 * PI * b * b;
    0.5 * area * (HEIGHT.0 + HEIGHT.1)
};

/// Returns a flower of six petals: in plan the curve r = 0.8 + 0.6 |sin 3 theta|, above and below
/// it surfaces that fall from the centre to this rim, where they meet at a sharp edge. Between
/// petals both have a concave crease from the centre to the notch. Star-shaped about the origin.
pub fn flower(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let notches: Vec<u32> = (0..PETALS).map(|k| b.vertex(rim(TAU * k as f64 / PETALS as f64))).collect();
    let poles = [b.vertex([0.0, 0.0, HEIGHT.0]), b.vertex([0.0, 0.0, -HEIGHT.1])];
    let per_petal = b.divisions(2.0 * (OUTLINE.1 + TAU * OUTLINE.0 / 12.0), 8);
    for k in 0..PETALS {
        let from = TAU * k as f64 / PETALS as f64;
        let step = TAU / (PETALS * per_petal) as f64;
        let next = notches[(k + 1) % PETALS];
        b.curve(notches[k], next, (1..per_petal).map(|i| rim(from + step * i as f64)));
        let n = b.divisions(OUTLINE.0, 2);
        for pole in poles {
            let (centre, notch) = (b.position(pole), b.position(notches[k]));
            let crease: Vec<Point> = (1..n)
                .map(|i| {
                    let s = i as f64 / n as f64;
                    let [x, y, _] = mix(centre, notch, s);
                    [x, y, centre[2] * (1.0 - s * s)]
                })
                .collect();
            b.curve(pole, notches[k], crease);
        }
    }
    for k in 0..PETALS {
        let (here, next) = (notches[k], notches[(k + 1) % PETALS]);
        let upper = b.outline(&[poles[0], here, next]);
        b.lifted(&[&upper], 2, |p| surface(p, HEIGHT.0));
        let lower = b.outline(&[poles[1], next, here]);
        b.lifted(&[&lower], 2, |p| surface(p, -HEIGHT.1));
    }
    b.finish()
}

fn radius(angle: f64) -> f64 {
    OUTLINE.0 + OUTLINE.1 * (0.5 * PETALS as f64 * angle).sin().abs()
}

fn rim(angle: f64) -> Point {
    let r = radius(angle);
    [r * angle.cos(), r * angle.sin(), 0.0]
}

fn surface([x, y, _]: Point, height: f64) -> Point {
    let s = x.hypot(y) / radius(y.atan2(x));
    [x, y, height * (1.0 - s * s)]
}
