//! The promise holds on the coordinates in the file: meshes are written, read again and judged, for
//! models of all sizes and far from the origin.

use exocarp::internals::io::load;
use exocarp::io::{SaveOptions, save};
use exocarp::verify::soundness;
use exocarp::{
    LatticeError, Length, OffsetError, OffsetSettings, Precision, RunSettings, TriMesh, VoxelSize, clean,
    offset, shapes,
};
use glam::{DQuat, DVec3};

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

/// Models with creases, needles and gaps, turned so that nothing lies in the lattice's planes.
fn models() -> [(&'static str, TriMesh); 4] {
    let turned = |mut mesh: TriMesh| {
        let rotation = DQuat::from_axis_angle(DVec3::new(3.0, -1.0, 2.0).normalize(), 1.1);
        for v in &mut mesh.vertices {
            *v = (rotation * DVec3::from(*v)).to_array();
        }
        mesh
    };
    [
        ("carved_cube", turned(shapes::carved_cube(6))),
        ("wedge", turned(shapes::wedge(4))),
        ("fin", turned(shapes::fin(4))),
        ("linked_tori", turned(shapes::linked_tori(12))),
    ]
}

fn placed(mesh: &TriMesh, scale: f64, shift: DVec3) -> TriMesh {
    let vertices = mesh.vertices.iter().map(|&v| (scale * DVec3::from(v) + shift).to_array()).collect();
    TriMesh { vertices, triangles: mesh.triangles.clone() }
}

fn settings(fraction: f64, precision: Precision) -> OffsetSettings {
    OffsetSettings {
        distance: Length::DiagonalFraction(fraction),
        voxel: VoxelSize::Resolution(40),
        precision,
        ..OffsetSettings::default()
    }
}

/// The mesh as it is after a trip through a file.
fn reread(mesh: &TriMesh, extension: &str, coordinates: Precision) -> TriMesh {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mesh").with_extension(extension);
    save(mesh, &path, &SaveOptions { precision: coordinates }).unwrap();
    clean(load(&path).unwrap()).0
}

fn assert_sound(mesh: &TriMesh, vertices: usize, what: &str) {
    // Two vertices at one place would have been welded.
    assert_eq!(mesh.vertices.len(), vertices, "{what}");
    let broken = soundness(mesh, &run()).unwrap().broken();
    assert!(broken.is_empty(), "{what}: {broken:?}");
}

#[test]
fn files_are_sound_at_every_size_of_the_model() {
    for (name, model) in models() {
        for scale in [1e-3, 1.0, 1e6] {
            // A little off the origin, so that coordinates are rounded.
            let model = placed(&model, scale, scale * DVec3::new(0.31, -1.7, 0.77));
            for fraction in [0.02, 0.0, -0.01] {
                let what = format!("{name} x {scale} {fraction}");
                let result = offset(&model, &settings(fraction, Precision::F32), &run()).expect(&what);
                for extension in ["ply", "stl", "obj", "off"] {
                    let again = reread(&result.mesh, extension, Precision::F32);
                    assert_eq!(again.triangles.len(), result.mesh.triangles.len(), "{what}");
                    assert_sound(&again, result.mesh.vertices.len(), &format!("{what} {extension}"));
                }
            }
        }
    }
}

#[test]
fn far_from_the_origin_coordinates_of_32_bits_are_refused_and_those_of_64_bits_are_sound() {
    for (name, model) in models() {
        // A diagonal is 2 to 4 units long.
        let model = placed(&model, 1.0, 1e5 * DVec3::new(2.3, -2.1, 3.7));
        for fraction in [0.02, -0.01] {
            let what = format!("{name} {fraction}");
            match offset(&model, &settings(fraction, Precision::F32), &run()) {
                Err(OffsetError::Lattice(LatticeError::CoarseCoordinates { .. })) => {}
                other => panic!("{what}: {other:?}"),
            }
            let result = offset(&model, &settings(fraction, Precision::F64), &run()).expect(&what);
            for extension in ["ply", "obj", "off"] {
                let again = reread(&result.mesh, extension, Precision::F64);
                assert_eq!(again, result.mesh, "{what} {extension}");
            }
            assert_sound(&result.mesh, result.mesh.vertices.len(), &what);
        }
    }
}

#[test]
fn between_the_two_whatever_is_written_is_sound() {
    // From where 32 bits are plenty to where they do not do any more.
    let (name, model) = models().into_iter().next().unwrap();
    let (mut sound, mut refused) = (0, 0);
    for step in 0..14 {
        let model = placed(&model, 1.0, 3f64.powi(step) * DVec3::new(0.7, -0.9, 1.3));
        match offset(&model, &settings(0.02, Precision::F32), &run()) {
            Ok(result) => {
                assert_eq!(refused, 0, "a model further out is refused first");
                let again = reread(&result.mesh, "stl", Precision::F32);
                assert_sound(&again, result.mesh.vertices.len(), &format!("{name} {step}"));
                sound += 1;
            }
            Err(OffsetError::Lattice(LatticeError::CoarseCoordinates { .. })) => refused += 1,
            Err(error) => panic!("{step}: {error}"),
        }
    }
    assert!(sound > 5 && refused > 2, "{sound} {refused}");
}
