//! Whole offsets in scalar code: the same bytes as in the machine's vectors.

use crate::geom::simd::scalar::in_vectors_and_scalars;
use crate::mesh::{TriMesh, shapes};
use crate::offset::{OffsetSettings, OpenInput, offset};
use crate::quantity::{Length, Precision, Tolerance, VoxelSize};
use crate::run::RunSettings;
use glam::{DQuat, DVec3};

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

/// Turns a mesh so that nothing lies in the lattice's planes.
fn turned(mut mesh: TriMesh) -> TriMesh {
    let rotation = DQuat::from_axis_angle(DVec3::new(2.0, -1.0, 3.0).normalize(), 0.8);
    for v in &mut mesh.vertices {
        *v = (rotation * DVec3::from(*v) + DVec3::new(0.1, -0.2, 0.3)).to_array();
    }
    mesh
}

fn bits(mesh: &TriMesh) -> Vec<[u64; 3]> {
    mesh.vertices.iter().map(|v| v.map(f64::to_bits)).collect()
}

#[track_caller]
fn assert_same_bytes([in_vectors, in_scalars]: [TriMesh; 2], what: &str) {
    assert!(in_vectors.triangles.len() > 500, "{what}: {}", in_vectors.triangles.len());
    assert!(in_vectors.triangles == in_scalars.triangles, "{what}: the triangles differ");
    assert!(bits(&in_vectors) == bits(&in_scalars), "{what}: the vertices differ");
}

#[test]
fn offsets_are_the_same_in_scalar_code() {
    let models = [
        ("carved_cube", turned(shapes::carved_cube(6)), OpenInput::Refuse),
        // Many triangles for each voxel, and round all over.
        ("flower", turned(shapes::flower(24)), OpenInput::Refuse),
        // Not turned: coplanar faces, and ties between triangles everywhere.
        ("bracket", shapes::bracket(6), OpenInput::Refuse),
        // Open: the sign jumps.
        ("wave", turned(shapes::wave(8)), OpenInput::Accept),
    ];
    for (name, mesh, open_input) in models {
        for fraction in [0.03, 0.0, -0.01] {
            for (tolerance, precision) in
                [(None, Precision::F32), (Some(Tolerance::Voxels(0.05)), Precision::F64)]
            {
                let settings = OffsetSettings {
                    distance: Length::DiagonalFraction(fraction),
                    voxel: VoxelSize::Resolution(32),
                    tolerance,
                    precision,
                    open_input,
                    ..OffsetSettings::default()
                };
                let what = format!("{name} {fraction} {tolerance:?}");
                let meshes = in_vectors_and_scalars(|| offset(&mesh, &settings, &run()).expect(&what).mesh);
                assert_same_bytes(meshes, &what);
            }
        }
    }
}
