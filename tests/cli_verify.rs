//! `exocarp verify`: what it prints and writes, and how it ends.

mod common;

use common::{exocarp, names};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Paths of a box, and of it shrunk by 0.25.
fn box_and_offset(dir: &Path) -> (String, String) {
    let at = |name: &str| dir.join(name).display().to_string();
    let (input, output) = (at("box.ply"), at("shrunk.stl"));
    assert_eq!(exocarp(&["model", "box", "-o", &input, "--detail", "4"]).code, 0);
    assert_eq!(exocarp(&["offset", &input, "-d", "-0.25", "--voxel", "0.0625", "-o", &output]).code, 0);
    (input, output)
}

#[test]
fn an_offset_of_ours_keeps_its_promises() {
    let dir = tempfile::tempdir().unwrap();
    let (input, output) = box_and_offset(dir.path());
    let json = dir.path().join("report.json");
    let common = ["verify", &input, &output, "-d", "-0.25", "--voxel", "0.0625", "--samples", "5000"];
    let more = ["--tolerance", "0.001", "--seed", "7", "--json", json.to_str().unwrap()];
    let outcome = exocarp(&[common.as_slice(), &more].concat());
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""), "{outcome:?}");
    for expected in ["keeps all promises", "seed 7", "intersecting pairs", "voxels", "with an edge along"] {
        assert!(outcome.stdout.contains(expected), "{expected}: {}", outcome.stdout);
    }
    assert_eq!(names(dir.path()), ["box.ply", "report.json", "shrunk.stl"]);

    let report: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    let keys: Vec<&String> = report.as_object().unwrap().keys().collect();
    let expected = [
        "exocarp",
        "command",
        "input",
        "output",
        "kept",
        "judged",
        "topology",
        "intersections",
        "distance",
        "missing",
        "creases",
        "shell",
        "broken",
        "wall",
    ];
    assert_eq!(keys, expected);
    assert_eq!((&report["kept"], &report["judged"]["seed"]), (&true.into(), &7.into()));
    assert_eq!(report["topology"]["genus"], 0);
    assert_eq!(report["intersections"]["pairs"], 0);
    for part in ["surface", "vertices", "edge_midpoints"] {
        for figure in ["mean", "rms", "p999", "max"] {
            assert!(report["distance"][part][figure]["voxels"].is_f64(), "{part} {figure}");
        }
    }
    assert_eq!(report["creases"]["share"], 1.0);

    // The same with more threads, but for the time.
    let again = exocarp(&[common.as_slice(), &more, &["--threads", "3"]].concat());
    let table = |text: &str| text.lines().rev().skip(1).map(String::from).collect::<Vec<_>>();
    assert_eq!(table(&outcome.stdout), table(&again.stdout));
}

#[test]
fn a_broken_promise_is_exit_6() {
    let dir = tempfile::tempdir().unwrap();
    let (input, output) = box_and_offset(dir.path());
    let broken = dir.path().join("broken.off").display().to_string();
    // A tetrahedron without one face.
    fs::write(&broken, "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n").unwrap();
    let json = dir.path().join("report.json");
    let outcome = exocarp(&["verify", &input, &broken, "-d", "1%", "--json", json.to_str().unwrap()]);
    assert_eq!(outcome.code, 6, "{outcome:?}");
    assert!(outcome.stderr.contains("3 border edges") && outcome.stderr.lines().count() == 1, "{outcome:?}");
    assert!(outcome.stdout.contains("breaks promises"), "{outcome:?}");
    let report: Value = serde_json::from_str(&fs::read_to_string(&json).unwrap()).unwrap();
    assert_eq!((&report["kept"], &report["broken"][0]["promise"]), (&false.into(), &"closed".into()));

    // Sound, but at another distance; then with the tolerance in percent; then no shell.
    let off = exocarp(&["verify", &input, &output, "-d", "-0.2", "--tolerance", "0.01"]);
    assert_eq!(off.code, 6, "{off:?}");
    assert!(off.stderr.contains("above 1.000000e-2"), "{off:?}");
    assert_eq!(exocarp(&["verify", &input, &output, "-d", "-0.2", "--tolerance", "4%"]).code, 0);
    let no_shell = exocarp(&["verify", &input, &output, "-d", "-0.25", "--shell"]);
    assert_eq!(no_shell.code, 6, "{no_shell:?}");
    assert!(no_shell.stderr.contains("two sheets"), "{no_shell:?}");
}

#[test]
fn wrong_use_and_bad_input() {
    let dir = tempfile::tempdir().unwrap();
    let (input, output) = box_and_offset(dir.path());
    exocarp(&["verify", &input, &output]).fails_with(2);
    exocarp(&["verify", &input, &output, "-d", "1%", "--samples", "0"]).fails_with(2);
    exocarp(&["verify", &input, &output, "-d", "1%", "--json", "/no/such/dir/a.json"]).fails_with(2);
    let missing = dir.path().join("missing.ply").display().to_string();
    exocarp(&["verify", &input, &missing, "-d", "1%"]).fails_with(3);
    let open = dir.path().join("wave.ply").display().to_string();
    assert_eq!(exocarp(&["model", "wave", "-o", &open, "--detail", "4"]).code, 0);
    exocarp(&["verify", &open, &output, "-d", "1%", "--sign", "closed"]).fails_with(3);
}
