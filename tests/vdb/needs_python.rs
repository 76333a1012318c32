//! The files as Python's OpenVDB sees them.

use crate::sphere::{Sphere, read_out};
use exocarp::internals::vdb::{info, open_surface, write};
use exocarp::vdb::Band;
use exocarp::vdb::{ClosestGrid, Compression, VdbError, VdbOptions};
use std::path::Path;
use std::process::Command;

/// The first Python that has an OpenVDB module. The system's comes first: distributions package the
/// module for that one.
fn python() -> Option<&'static str> {
    ["/usr/bin/python3", "python3"].into_iter().find(|python| {
        ["pyopenvdb", "openvdb"].iter().any(|module| {
            let import = Command::new(python).args(["-c", &format!("import {module}")]).output();
            import.is_ok_and(|o| o.status.success())
        })
    })
}

/// Runs a script of tests/python and returns what it says.
pub fn run(script: &str, arguments: &[&str]) -> String {
    let python = python().expect("python3 with pyopenvdb or openvdb");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python").join(script);
    let output = Command::new(python).arg(script).args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    said
}

/// No node is at exactly three voxels from it, where OpenVDB's spheres end.
const SPHERE: Sphere = Sphere { radius: 2.01, voxel: 0.1, half_width: 3.0 };

#[test]
#[ignore = "needs python3 with OpenVDB's module"]
fn python_reads_the_same_level_set() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sphere.vdb");
    let band = SPHERE.band();
    let active = band.surface.active_voxels().to_string();
    let sphere = ["--sphere", "2.01", "--voxel", "0.1", "--half-width", "3", "--active", &active];
    // Alone in its file, which the module reads as a whole; and beside the closest triangles.
    for (closest, more) in [(None, &[][..]), (band.closest.as_ref(), &["--two-grids"])] {
        for compression in [Compression::Blosc, Compression::Zip, Compression::None] {
            let (distance, unit) = (Some(0.5), Some("mm".into()));
            let options = VdbOptions { compression, distance, unit, ..VdbOptions::default() };
            write(&path, &band.surface, closest, &options).unwrap();
            let arguments = [&[path.to_str().unwrap()], &sphere[..], more].concat();
            let said = run("test_vdb.py", &arguments);
            assert!(said.contains("1000 random nodes"), "{said}");
        }
    }
}

#[test]
#[ignore = "needs python3 with OpenVDB's module"]
fn grids_of_another_program_open() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("other.vdb");
    run("make_vdb.py", &[path.to_str().unwrap()]);
    // OpenVDB's own sphere has the leaves and active nodes of the one built by hand.
    let own = SPHERE.band();
    let open = |name| Band { surface: open_surface(&path, Some(name)).unwrap(), closest: own_closest() };
    let expected = read_out(&own);
    for name in ["plain", "shared", "moved"] {
        let read = read_out(&open(name));
        assert_eq!((&read.origins, &read.active), (&expected.origins, &expected.active), "{name}");
        let nearly = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-5;
        assert!(read.values.iter().zip(&expected.values).all(nearly), "{name}");
    }
    assert_eq!(open("plain").surface.translation(), [0.0; 3]);
    let moved = open("moved").surface;
    assert!(
        moved.translation().iter().zip([1.0, -2.0, 0.5]).all(|(a, b)| (a - b).abs() < 1e-12),
        "{moved:?}"
    );

    for name in ["turned", "stretched", "fog"] {
        let error = open_surface(&path, Some(name)).unwrap_err();
        assert!(matches!(error, VdbError::Unsuitable { .. }), "{name}: {error}");
    }
    // Several float grids and none of the usual name: the user has to choose.
    let error = open_surface(&path, None).unwrap_err().to_string();
    assert!(error.contains("'plain' (float)") && error.contains("'mask' (bool)"), "{error}");

    let file = info(&path).unwrap();
    let grid = |name: &str| file.grids.iter().find(|g| g.name == name).unwrap();
    assert_eq!(file.grids.len(), 7);
    assert_eq!((grid("mask").active_voxels, grid("mask").world_bbox), (0, None));
    assert_eq!(grid("shared").active_voxels, own.surface.active_voxels());
    assert_eq!(grid("fog").class, "fog volume");
    let voxel = grid("stretched").voxel;
    assert!(voxel.iter().zip([0.1, 0.2, 0.1]).all(|(a, b)| (a - b).abs() < 1e-12), "{voxel:?}");
}

fn own_closest() -> Option<ClosestGrid> {
    SPHERE.band().closest
}
