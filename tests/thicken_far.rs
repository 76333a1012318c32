//! Small random patches at thicknesses from next to nothing to a thousand times their size: sound
//! solids, or refused.
//!
//! `EXOCARP_HEAVY=1` makes 500 of them.

mod common;

use common::random::Random;
use common::thickened::{audit, check};
use exocarp::{
    LatticeError, Length, PatchSide, Precision, RunSettings, ThickenError, ThickenSettings, TriMesh,
    VoxelSize, thicken,
};

/// A case takes at most about this much: a second of work.
const MEMORY: u64 = 100 << 20;

/// A height field over up to 8 x 8 squares, flat to rugged, of any size and anywhere; some with
/// holes and touching corners, some of two sheets.
fn patch(random: &mut Random) -> TriMesh {
    let (n, m) = (1 + random.next() as u32 % 8, 1 + random.next() as u32 % 8);
    let (rough, jitter) = (random.of(&[0.0, 0.01, 0.1, 0.3, 1.0]), random.of(&[0.0, 0.0, 0.2]));
    let mut mesh = TriMesh::default();
    for i in 0..=n {
        for j in 0..=m {
            let mut off = |most: f64| most * random.within(-1.0..1.0);
            mesh.vertices.push([f64::from(i) + off(jitter), f64::from(j) + off(jitter), off(rough)]);
        }
    }
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let a = i * (m + 1) + j;
        let b = a + m + 1;
        let cut = random.of(&[[[a, b, b + 1], [a, b + 1, a + 1]], [[a, b, a + 1], [b, b + 1, a + 1]]]);
        mesh.triangles.extend(cut);
    }
    match random.next() % 10 {
        0..3 if mesh.triangles.len() > 4 => mesh.triangles.retain(|_| !random.next().is_multiple_of(7)),
        9 => {
            let first = mesh.vertices.len() as u32;
            let above = random.within(0.5..4.0);
            mesh.vertices.extend_from_within(..);
            mesh.vertices[first as usize..].iter_mut().for_each(|v| v[2] += above);
            mesh.triangles.extend_from_within(..);
            let count = mesh.triangles.len() / 2;
            mesh.triangles[count..].iter_mut().for_each(|t| *t = t.map(|v| v + first));
        }
        _ => {}
    }
    let turn = glam::DQuat::from_rotation_y(random.within(0.0..6.0)) * glam::DQuat::from_rotation_x(0.3);
    let far = random.of(&[0.0, 0.0, 10.0, 1000.0]);
    let shift = glam::DVec3::from_array([0; 3].map(|_| far * random.within(-1.0..1.0)));
    let scale = random.log_within(-3.0..3.0);
    for v in &mut mesh.vertices {
        *v = (scale * (turn * glam::DVec3::from(*v) + shift)).to_array();
    }
    mesh
}

fn settings(random: &mut Random) -> ThickenSettings {
    let thickness = random.log_within(-5.0..3.0);
    // Fine enough for the thickness, most of the time. Thin ones take a voxel size of their own.
    let resolution = random.of(&[4, 5, 6, 8, 12, 12, 16, 24, 32]);
    let resolution = random.of(&[resolution, resolution.max((2.0 / thickness) as u32 + 5)]);
    ThickenSettings {
        thickness: Length::DiagonalFraction(thickness),
        side: random.of(&[PatchSide::Inner, PatchSide::Outer]),
        voxel: (thickness > 0.05).then_some(VoxelSize::Resolution(resolution)),
        rounds: random.of(&[0, 10, 10]),
        precision: random.of(&[Precision::F32, Precision::F32, Precision::F64]),
        max_memory: Some(MEMORY),
        ..ThickenSettings::default()
    }
}

#[test]
fn random_patches_of_any_thickness_are_sound_or_refused() {
    let is_heavy = std::env::var_os("EXOCARP_HEAVY").is_some_and(|v| v == "1");
    let count = if is_heavy { 500 } else { 60 };
    let run = RunSettings::with_threads(2).unwrap();
    let (mut sound, mut far, mut refused) = (0u64, 0, 0);
    for seed in 0..count {
        let mut random = Random(seed);
        let (mesh, settings) = (patch(&mut random), settings(&mut random));
        match thicken(&mesh, &settings, &run) {
            Ok(result) => {
                eprintln!("seed {seed}: {settings:?}");
                audit(&mesh, &settings, &result);
                sound += 1;
                far +=
                    u64::from(matches!(settings.thickness, Length::DiagonalFraction(share) if share > 10.0));
            }
            Err(
                ThickenError::Settings(_)
                | ThickenError::Patch(_)
                | ThickenError::Obstacle { .. }
                | ThickenError::Memory(_)
                | ThickenError::Lattice(LatticeError::CoarseCoordinates { .. }),
            ) => refused += 1,
            Err(error) => panic!("seed {seed}, {settings:?}: {error}"),
        }
    }
    assert!(sound > count / 5 && far > count / 50 && refused > count / 20, "{sound} {far} {refused}");
}

#[test]
fn a_patch_that_is_small_beside_the_voxels_has_each_edge_twice() {
    let mut random = Random(7);
    let mut mesh = TriMesh::default();
    for n in 0..64 {
        mesh.vertices.push([f64::from(n / 8), f64::from(n % 8), 0.1 * random.within(-1.0..1.0)]);
    }
    for a in (0..56).filter(|a| a % 8 < 7) {
        mesh.triangles.extend([[a, a + 8, a + 9], [a, a + 9, a + 1]]);
    }
    let mut solids = 0;
    for diagonals in [30.0, 100.0, 516.0, 1000.0] {
        for (side, resolution) in
            [(PatchSide::Outer, 12), (PatchSide::Inner, 12), (PatchSide::Outer, 7), (PatchSide::Inner, 32)]
        {
            let settings = ThickenSettings {
                thickness: Length::DiagonalFraction(diagonals),
                voxel: Some(VoxelSize::Resolution(resolution)),
                side,
                ..ThickenSettings::default()
            };
            match thicken(&mesh, &settings, &RunSettings::with_threads(2).unwrap()) {
                Ok(result) => {
                    audit(&mesh, &settings, &result);
                    solids += 1;
                }
                Err(error) => {
                    assert!(error.to_string().contains("smaller voxel size or thickness"), "{error}")
                }
            }
        }
    }
    assert!(solids > 2, "{solids}");
}

#[test]
fn what_would_not_fit_is_refused_before_it_starts() {
    let mesh = TriMesh {
        vertices: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    let settings = |thickness: f64, voxel: f64, max_memory: u64| ThickenSettings {
        thickness: Length::Units(thickness),
        voxel: Some(VoxelSize::Units(voxel)),
        max_memory: Some(max_memory),
        ..ThickenSettings::default()
    };
    // Thin and fine; and far more thick than wide, where half a ball of nodes has to be looked at.
    for (thickness, voxel) in [(0.01, 1e-3), (400.0, 1.0)] {
        match thicken(&mesh, &settings(thickness, voxel, 200 << 20), &RunSettings::with_threads(2).unwrap()) {
            Err(ThickenError::Memory(error)) => {
                assert!(error.needed > 300 << 20, "{error}");
                assert!(error.smallest_voxel > voxel && error.smallest_voxel < 10.0 * voxel, "{error}");
            }
            other => panic!("{other:?}"),
        }
    }
    check(&mesh, &settings(0.2, 0.05, 20 << 20));
}
