//! The promises of the module, on generated patches.

use super::*;
use crate::offset::{Length, VoxelSize};
use crate::verify::soundness;

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

/// A flat square of side 2 with n x n x 2 triangles.
fn square(n: usize) -> TriMesh {
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    let vertices = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j), 0.0])).collect();
    let number = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let cells = (0..n).flat_map(|j| (0..n).map(move |i| (i, j)));
    let triangles = cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriMesh { vertices, triangles }
}

#[track_caller]
fn check(patch: &TriMesh, settings: &ThickenSettings) -> ThickenResult {
    let result = thicken(patch, settings, &run()).unwrap();
    let report = soundness(&result.mesh, &run()).unwrap();
    let broken = report.broken();
    assert!(broken.is_empty(), "{broken:?} {report:?}");
    result
}

#[test]
fn a_square_becomes_a_plate() {
    for n in [1, 7, 40] {
        for side in [Side::Inner, Side::Outer] {
            let settings = ThickenSettings {
                thickness: Length::Units(0.2),
                voxel: Some(VoxelSize::Units(0.047)),
                side,
                ..ThickenSettings::default()
            };
            let result = check(&square(n), &settings);
            let volume = crate::mesh::measure::signed_volume(&result.mesh);
            eprintln!("{n} {side:?} {volume} {:?}", result.statistics);
            assert!((volume / 0.8 - 1.0).abs() < 0.005, "{volume}");
        }
    }
}
