//! The true offset surface on a plane: the exact curve phi = 0.

use super::plane::{Plane, Segment};
use crate::distance::SignedDistance;
use crate::run::RunSettings;
use glam::DVec2;
use rayon::prelude::*;

/// Cells along a side of the square in which the curve is traced. Two cells are about a pixel of
/// the picture, and the ends of each piece are exact, so a finer one would look the same.
const CELLS: usize = 280;

/// Halvings and regula falsi steps for a point of the curve: far below a thousandth of a cell.
const STEPS: usize = 8;

/// The true offset solid on a plane.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Border of the true solid: the curve where dis = r.
    pub curve: Vec<Segment>,
    /// Inside of the true solid, as lines along x, [`Outline::pitch`] from each other.
    pub inside: Vec<Segment>,
    /// The distance between those lines.
    pub pitch: f64,
}

/// The solid dis < `r` on `plane`, not farther than `half` from its origin in x or y.
pub fn outline(distance: &SignedDistance, r: f64, plane: &Plane, half: f64, run: &RunSettings) -> Outline {
    let step = 2.0 * half / CELLS as f64;
    let place = |i: usize, j: usize| DVec2::new(i as f64, j as f64) * step - DVec2::splat(half);
    let phi = |p: DVec2, guess: &mut u32| {
        let sample = distance.at(plane.at(p), *guess);
        *guess = sample.triangle;
        sample.distance - r
    };
    let row = |j: usize| -> Vec<f64> {
        let mut guess = 0;
        (0..=CELLS).map(|i| phi(place(i, j), &mut guess)).collect()
    };
    let cells = |(j, pair): (usize, &[Vec<f64>])| -> Vec<Segment> {
        let mut guess = 0;
        let mut segments = Vec::new();
        for i in 0..CELLS {
            // Corners counter-clockwise from the lower left.
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| place(i, j));
            let values = [pair[0][i], pair[0][i + 1], pair[1][i + 1], pair[1][i]];
            let mut roots = Vec::new();
            for k in 0..4 {
                let l = (k + 1) % 4;
                if (values[k] < 0.0) != (values[l] < 0.0) {
                    let ends = [(corners[k], values[k]), (corners[l], values[l])];
                    roots.push(root(ends, |p| phi(p, &mut guess)));
                }
            }
            match roots[..] {
                [a, b] => segments.push([a, b]),
                [a, b, c, d] => {
                    // Two pieces: which corners belong together, the middle says.
                    let middle = phi(corners[0].midpoint(corners[2]), &mut guess);
                    let joined = (middle < 0.0) == (values[0] < 0.0);
                    segments.extend(if joined { [[a, b], [c, d]] } else { [[d, a], [b, c]] });
                }
                _ => {}
            }
        }
        segments
    };
    run.install(|| {
        let rows: Vec<Vec<f64>> = (0..=CELLS).into_par_iter().map(row).collect();
        let by_row: Vec<Vec<Segment>> =
            (0..CELLS).into_par_iter().map(|j| cells((j, &rows[j..j + 2]))).collect();
        let inside = rows.iter().enumerate().flat_map(|(j, row)| {
            let mut runs = Vec::new();
            for run in (0..=CELLS).collect::<Vec<_>>().chunk_by(|&a, &b| (row[a] < 0.0) == (row[b] < 0.0)) {
                if let [first, .., last] = *run
                    && row[first] < 0.0
                {
                    runs.push([place(first, j), place(last, j)]);
                }
            }
            runs
        });
        Outline { inside: inside.collect(), curve: by_row.into_iter().flatten().collect(), pitch: step }
    })
}

/// The zero between two points with values of different sign: secants and halvings in turn.
fn root([mut a, mut b]: [(DVec2, f64); 2], mut phi: impl FnMut(DVec2) -> f64) -> DVec2 {
    for step in 0..STEPS {
        let along = if step % 2 == 0 { a.1 / (a.1 - b.1) } else { 0.5 };
        let p = a.0.lerp(b.0, along);
        let value = phi(p);
        if value == 0.0 {
            return p;
        }
        if (value < 0.0) == (a.1 < 0.0) { a = (p, value) } else { b = (p, value) }
    }
    a.0.lerp(b.0, a.1 / (a.1 - b.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Topology, shapes};
    use glam::DVec3;

    #[test]
    fn a_grown_cube_has_round_corners() {
        let mesh = shapes::cube(2);
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        let run = RunSettings::with_threads(2).unwrap();
        let plane = Plane::new(DVec3::ZERO, DVec3::Y, DVec3::Z);
        let Outline { curve, inside, pitch } = outline(&distance, 0.5, &plane, 2.0, &run);
        let area: f64 = inside.iter().map(|[a, b]| a.distance(*b) * pitch).sum();
        let expected = 4.0 + 4.0 + 0.25 * std::f64::consts::PI;
        assert!((area - expected).abs() < 0.1, "{area} {expected}");
        let length: f64 = curve.iter().map(|[a, b]| a.distance(*b)).sum();
        let expected = 8.0 + std::f64::consts::PI;
        assert!((length - expected).abs() < 1e-3, "{length} {expected}");
        for p in curve.iter().flatten() {
            let sample = distance.at(plane.at(*p), 0);
            assert!((sample.distance - 0.5).abs() < 1e-6, "{p}: {}", sample.distance);
        }
    }
}
