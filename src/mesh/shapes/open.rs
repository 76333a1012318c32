//! Open patches.

use super::builder::Builder;
use crate::mesh::TriMesh;
use std::f64::consts::PI;

/// Height of the waves of [`wave`].
const AMPLITUDE: f64 = 0.2;

/// Returns an open wavy patch over the square from (-1, -1) to (1, 1), its front side up.
pub fn wave(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let n = b.divisions(2.0, 4);
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let rows: Vec<Vec<u32>> = (0..=n)
        .map(|j| {
            b.vertices((0..=n).map(|i| {
                let (x, y) = (at(i), at(j));
                [x, y, AMPLITUDE * (1.5 * PI * x).sin() * (PI * y).cos()]
            }))
        })
        .collect();
    for pair in rows.windows(2) {
        b.strip(&pair[0], &pair[1]);
    }
    b.finish()
}
