//! `exocarp thicken`: files, statistics, and what it refuses.

mod common;

use common::{exocarp, names};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Writes a flat square of side 2 in four triangles, and returns its path.
fn square(dir: &Path) -> String {
    let path = dir.join("square.off").display().to_string();
    fs::write(
        &path,
        "OFF\n5 4 0\n-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n0 0 0\n3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n",
    )
    .unwrap();
    path
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

#[test]
fn a_patch_becomes_a_solid_with_level_set_and_statistics() {
    let dir = tempfile::tempdir().unwrap();
    let input = square(dir.path());
    let at = |name: &str| dir.path().join(name).display().to_string();
    let (solid, vdb, stats) = (at("solid.stl"), at("solid.vdb"), at("stats.json"));
    let outcome = exocarp(&["thicken", &input, "-t", "0.4", "-o", &solid, "--vdb", &vdb, "--stats", &stats]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    assert_eq!(outcome.stdout.lines().count(), 1);
    assert_eq!(names(dir.path()), ["solid.stl", "solid.vdb", "square.off", "stats.json"]);

    let info = json(&exocarp(&["info", &solid, "--json"]).stdout);
    assert_eq!((&info["closed"], &info["manifold"]), (&true.into(), &true.into()));
    let grids = json(&exocarp(&["info", &vdb, "--json"]).stdout);
    assert_eq!(grids["grids"][0]["class"], "level set");

    let stats = json(&fs::read_to_string(&stats).unwrap());
    assert_eq!(stats["command"], "thicken");
    for phase in ["load", "clean", "hierarchy", "nodes", "boundary", "faces", "shape", "write"] {
        assert!(stats["phases"][phase].is_number(), "{phase}");
    }
    assert_eq!(stats["triangles"]["kept"], 4);
    assert_eq!(stats["triangles"]["split"], 0);
    let new = stats["triangles"]["new"].as_u64().unwrap();
    assert_eq!(info["triangles"], new + 4);
    assert_eq!(stats["settings"]["side"], "inner");
    assert!((stats["settings"]["voxel"].as_f64().unwrap() - 0.1).abs() < 1e-12, "a quarter of the thickness");
}

#[test]
fn a_thickness_map_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let input = square(dir.path());
    let at = |name: &str| dir.path().join(name).display().to_string();
    let (map, solid) = (at("map.txt"), at("solid.ply"));
    fs::write(&map, "0.3 0.5 # front\n0.5 0.3\n0.4\n").unwrap();
    let outcome = exocarp(&["thicken", &input, "--thickness-map", &map, "-o", &solid, "-q"]);
    assert_eq!((outcome.code, outcome.stdout.as_str(), outcome.stderr.as_str()), (0, "", ""));

    // The same values in a PLY file are the same map.
    let (ply, same) = (at("map.ply"), at("same.ply"));
    let header = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                  property double thickness\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let vertices = "0 0 0 0.3\n1 0 0 0.5\n0 1 0 0.5\n0 0 1 0.3\n0 2 0 0.4\n3 0 1 2\n";
    fs::write(&ply, format!("{header}{vertices}")).unwrap();
    let outcome = exocarp(&["thicken", &input, "--thickness-map", &ply, "-o", &same, "-q"]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    assert!(fs::read(&same).unwrap() == fs::read(&solid).unwrap());
    fs::remove_file(&same).unwrap();
    fs::write(&ply, format!("{header}{vertices}").replace("thickness", "quality")).unwrap();
    let outcome = exocarp(&["thicken", &input, "--thickness-map", &ply, "-o", &same]);
    outcome.fails_with(3);
    assert!(outcome.stderr.contains("no property thickness"), "{}", outcome.stderr);
    fs::remove_file(&ply).unwrap();

    fs::write(&map, "0.3 0.5\n").unwrap();
    exocarp(&["thicken", &input, "--thickness-map", &map, "-o", &at("none.ply")]).fails_with(3);
    fs::write(&map, "0.3 0.5 -1 1 1\n").unwrap();
    exocarp(&["thicken", &input, "--thickness-map", &map, "-o", &at("none.ply")]).fails_with(3);
    assert_eq!(names(dir.path()), ["map.txt", "solid.ply", "square.off"]);
}

#[test]
fn what_cannot_be_thickened_ends_with_its_exit_code_and_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let input = square(dir.path());
    let output = dir.path().join("solid.ply").display().to_string();
    let with = |arguments: &[&str]| {
        exocarp(&[&["thicken", input.as_str(), "-o", output.as_str()], arguments].concat())
    };
    with(&["-t", "-1"]).fails_with(2);
    with(&["-t", "0.4", "--voxel", "0.2"]).fails_with(2);
    with(&[]).fails_with(2);
    with(&["-t", "0.4", "--vdb", "solid.txt"]).fails_with(2);

    let outcome = with(&["-t", "0.4", "--resolution", "2000", "--max-memory", "64M"]);
    outcome.fails_with(5);
    assert!(outcome.stderr.contains("--max-memory"), "{}", outcome.stderr);

    let crossing = dir.path().join("crossing.off").display().to_string();
    fs::write(&crossing, "OFF\n6 2 0\n0 0 0\n2 0 0\n0 2 0\n0.5 0.5 -1\n0.5 0.5 1\n3 3 1\n3 0 1 2\n3 3 4 5\n")
        .unwrap();
    let outcome = exocarp(&["thicken", &crossing, "-t", "0.4", "-o", &output]);
    outcome.fails_with(3);
    assert!(outcome.stderr.contains("intersects itself"), "{}", outcome.stderr);
    assert_eq!(names(dir.path()), ["crossing.off", "square.off"]);
}
