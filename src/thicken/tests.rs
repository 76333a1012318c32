//! Thickened patches in scalar code: the same bytes as in the machine's vectors.

use super::{Side, ThickenSettings, thicken};
use crate::geom::simd::scalar::in_vectors_and_scalars;
use crate::mesh::{TriMesh, shapes};
use crate::quantity::Length;
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

#[test]
fn thickened_patches_are_the_same_in_scalar_code() {
    for (name, patch) in [("wave", shapes::wave(12)), ("turned wave", turned(shapes::wave(12)))] {
        for side in [Side::Inner, Side::Outer] {
            let settings = ThickenSettings {
                thickness: Length::DiagonalFraction(0.03),
                side,
                ..ThickenSettings::default()
            };
            let what = format!("{name} {side:?}");
            let [in_vectors, in_scalars] =
                in_vectors_and_scalars(|| thicken(&patch, &settings, &run()).expect(&what).mesh);
            assert!(in_vectors.triangles.len() > 2 * patch.triangles.len(), "{what}");
            assert!(in_vectors.triangles == in_scalars.triangles, "{what}: the triangles differ");
            let bits = |mesh: &TriMesh| -> Vec<[u64; 3]> {
                mesh.vertices.iter().map(|v| v.map(f64::to_bits)).collect()
            };
            assert!(bits(&in_vectors) == bits(&in_scalars), "{what}: the vertices differ");
        }
    }
}
