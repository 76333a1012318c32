//! Meshes that nothing can be made of, given to the library: an error that names the culprit, no
//! panic.

use exocarp::{
    Length, OffsetError, OffsetSettings, OpenInput, RunSettings, ThickenError, ThickenSettings, TriMesh,
    VoxelSize, offset, offset_band, shapes, thicken,
};

fn run() -> RunSettings {
    RunSettings::with_threads(1).unwrap()
}

/// A mesh with something wrong, and what is said of it.
fn wrong_meshes(mesh: &TriMesh) -> Vec<(TriMesh, String)> {
    let count = mesh.vertices.len();
    let mut all = Vec::new();
    for vertex in [count as u32, u32::MAX] {
        for (triangle, corner) in [(0, 0), (2, 1), (mesh.triangles.len() - 1, 2)] {
            let mut wrong = mesh.clone();
            wrong.triangles[triangle][corner] = vertex;
            all.push((wrong, format!("triangle {triangle} names vertex {vertex}, and there are {count}")));
        }
    }
    for coordinate in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (vertex, axis) in [(0, 0), (3, 1), (count - 1, 2)] {
            let mut wrong = mesh.clone();
            wrong.vertices[vertex][axis] = coordinate;
            all.push((wrong, format!("vertex {vertex} has a coordinate that is not a finite number")));
        }
    }
    all
}

#[test]
fn offset_and_its_band_refuse_meshes_that_are_none() {
    for (mesh, expected) in wrong_meshes(&shapes::cube(1)) {
        for open_input in [OpenInput::Refuse, OpenInput::Accept] {
            // A distance in units and one that is a part of the diagonal, which is not finite,
            // either.
            for distance in [Length::Units(0.1), Length::DiagonalFraction(0.02)] {
                let settings = OffsetSettings {
                    distance,
                    voxel: VoxelSize::Resolution(16),
                    open_input,
                    ..OffsetSettings::default()
                };
                let errors = [
                    offset(&mesh, &settings, &run()).map(drop).unwrap_err(),
                    offset_band(&mesh, &settings, &run()).map(drop).unwrap_err(),
                ];
                for error in errors {
                    assert!(matches!(error, OffsetError::Input(_)), "{error:?}");
                    assert_eq!(error.to_string(), expected);
                }
            }
        }
    }
}

#[test]
fn thicken_refuses_meshes_that_are_none() {
    for mesh in [shapes::wave(4), shapes::cube(1)] {
        for (wrong, expected) in wrong_meshes(&mesh) {
            let settings =
                ThickenSettings { thickness: Length::DiagonalFraction(0.02), ..ThickenSettings::default() };
            let error = thicken(&wrong, &settings, &run()).map(drop).unwrap_err();
            assert!(matches!(error, ThickenError::Patch(_)), "{error:?}");
            assert_eq!(error.to_string(), expected);
        }
    }
}
