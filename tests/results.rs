//! Results and errors keep their word: files hold the precision that was promised, and an error
//! leads to its cause.

use exocarp::io::{self, SaveErrorKind, SaveOptions};
use exocarp::{Length, OffsetSettings, Precision, RunSettings, TriMesh, VoxelSize, offset, shapes};
use std::error::Error;

fn offset_with(precision: Precision) -> exocarp::OffsetResult {
    let settings = OffsetSettings {
        distance: Length::Units(0.1),
        voxel: VoxelSize::Resolution(24),
        precision,
        ..OffsetSettings::default()
    };
    offset(&shapes::carved_cube(4), &settings, &RunSettings::default()).unwrap()
}

#[test]
fn what_is_made_for_64_bits_is_written_with_64_bits() {
    let dir = tempfile::tempdir().unwrap();
    let result = offset_with(Precision::F64);
    assert_eq!(result.precision, Precision::F64);
    let is_single = |x: &f64| f64::from(*x as f32) == *x;
    assert!(!result.mesh.vertices.as_flattened().iter().all(is_single), "the case tells nothing");
    for extension in ["ply", "obj", "off"] {
        let path = dir.path().join(format!("a.{extension}"));
        result.save(&path).unwrap();
        assert_eq!(TriMesh::load(&path).unwrap(), result.mesh, "{extension}");
        // The mesh by itself loses nothing, either.
        result.mesh.save(&path).unwrap();
        assert_eq!(TriMesh::load(&path).unwrap(), result.mesh, "{extension}");
    }
    let path = dir.path().join("a.stl");
    let error = result.save(&path).unwrap_err();
    assert!(matches!(error.kind, SaveErrorKind::NoF64(_)), "{error}");
    assert!(!path.exists());
}

#[test]
fn what_is_made_for_32_bits_takes_32_bits() {
    let dir = tempfile::tempdir().unwrap();
    let result = offset_with(Precision::F32);
    let [by_result, by_mesh, by_options] = ["a.ply", "b.ply", "c.ply"].map(|name| dir.path().join(name));
    result.save(&by_result).unwrap();
    result.mesh.save(&by_mesh).unwrap();
    io::save(&result.mesh, &by_options, &SaveOptions { precision: Precision::F32 }).unwrap();
    let bytes = std::fs::read(&by_result).unwrap();
    assert_eq!(bytes, std::fs::read(&by_mesh).unwrap());
    assert_eq!(bytes, std::fs::read(&by_options).unwrap());
    result.save(dir.path().join("a.stl")).unwrap();
}

/// The system's error at the end of the chain of causes.
fn system_error(error: &(dyn Error + 'static)) -> Option<std::io::ErrorKind> {
    let mut next = Some(error);
    while let Some(error) = next {
        if let Some(found) = error.downcast_ref::<std::io::Error>() {
            return Some(found.kind());
        }
        next = error.source();
    }
    None
}

#[test]
fn the_errors_of_the_system_are_reached_by_source() {
    let dir = tempfile::tempdir().unwrap();
    let (missing, nowhere) = (dir.path().join("none.ply"), dir.path().join("none/a.ply"));
    let errors: [exocarp::Error; 4] = [
        TriMesh::load(&missing).unwrap_err().into(),
        shapes::sphere(2).save(&nowhere).unwrap_err().into(),
        exocarp::vdb::Band::open(&missing).unwrap_err().into(),
        io::merge_tiles(std::slice::from_ref(&missing), &nowhere).unwrap_err().into(),
    ];
    for error in errors {
        assert_eq!(system_error(&error), Some(std::io::ErrorKind::NotFound), "{error}");
    }
}
