//! The files as Python's OpenVDB sees them.

use crate::sphere::Sphere;
use exocarp::vdb::{VdbOptions, write};
use std::process::Command;

/// The first Python that has an OpenVDB module. The system's comes first: distributions package the module
/// for that one.
fn python() -> Option<&'static str> {
    ["/usr/bin/python3", "python3"].into_iter().find(|python| {
        ["pyopenvdb", "openvdb"].iter().any(|module| {
            let import = Command::new(python).args(["-c", &format!("import {module}")]).output();
            import.is_ok_and(|o| o.status.success())
        })
    })
}

#[test]
fn python_reads_the_same_level_set() {
    let Some(python) = python() else {
        eprintln!("SKIPPED vdb::python::python_reads_the_same_level_set: no python3 with pyopenvdb");
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sphere.vdb");
    let sphere = Sphere { radius: 2.0, voxel: 0.1, half_width: 3.0 };
    let band = sphere.band();
    let options = VdbOptions { distance: Some(0.5), unit: Some("mm".into()), ..VdbOptions::default() };
    write(&path, &band.surface, band.closest.as_ref(), &options).unwrap();

    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/test_vdb.py");
    let output = Command::new(python)
        .arg(script)
        .arg(&path)
        .args(["--sphere", "2.0", "--voxel", "0.1", "--half-width", "3"])
        .args(["--active", &band.surface.active_voxels().to_string()])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}\n{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("1000 random nodes"), "{said}");
}
