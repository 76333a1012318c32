//! The program with the engine: files, statistics, warnings, and what stops it.

mod common;

use common::{command, exocarp, names};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Writes a model and returns its path.
fn model(dir: &Path, name: &str, detail: &str) -> String {
    let path = dir.join(format!("{name}.ply")).display().to_string();
    assert_eq!(exocarp(&["model", name, "-o", &path, "--detail", detail]).code, 0);
    path
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn an_offset_writes_mesh_band_and_statistics() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "carved_cube", "6");
    let at = |name: &str| dir.path().join(name);
    let outcome = exocarp(&[
        "offset",
        &input,
        "-d",
        "2%",
        "--resolution",
        "48",
        "-o",
        at("out.stl").to_str().unwrap(),
        "--vdb",
        at("out.vdb").to_str().unwrap(),
        "--unit",
        "mm",
        "--stats",
        at("out.json").to_str().unwrap(),
    ]);
    assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
    assert_eq!(outcome.stdout.lines().count(), 1);
    assert_eq!(names(dir.path()), ["carved_cube.ply", "out.json", "out.stl", "out.vdb"]);

    let info: Value =
        serde_json::from_str(&exocarp(&["info", at("out.stl").to_str().unwrap(), "--json"]).stdout).unwrap();
    assert_eq!((&info["closed"], &info["manifold"]), (&true.into(), &true.into()));
    let vdb: Value =
        serde_json::from_str(&exocarp(&["info", at("out.vdb").to_str().unwrap(), "--json"]).stdout).unwrap();
    assert_eq!(
        (&vdb["grids"][0]["name"], &vdb["grids"][0]["class"]),
        (&"surface".into(), &"level set".into())
    );
    assert_eq!(vdb["metadata"]["unit"], "mm");

    let stats = json(&at("out.json"));
    assert_eq!(stats["contour"]["triangles"], info["triangles"]);
    assert_eq!(stats["vdb"]["active_voxels"], vdb["grids"][0]["active_voxels"]);
}

#[test]
fn the_statistics_file_has_the_fields_of_the_contract() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "box", "4");
    let (output, stats) = (dir.path().join("out.ply"), dir.path().join("out.json"));
    let outcome = exocarp(&[
        "offset",
        &input,
        "-d",
        "-0.125",
        "--voxel",
        "0.0625",
        "-o",
        output.to_str().unwrap(),
        "--stats",
        stats.to_str().unwrap(),
        "--threads",
        "2",
    ]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let stats = json(&stats);
    let keys = |value: &Value| -> Vec<String> { value.as_object().unwrap().keys().cloned().collect() };
    assert_eq!(
        keys(&stats),
        [
            "exocarp",
            "command",
            "input",
            "settings",
            "phases",
            "wall",
            "peak_rss",
            "filter",
            "edges",
            "contour",
            "lone_nodes",
            "unseen",
            "slabs",
            "halvings",
            "vdb"
        ]
    );
    let has = |part: &str, fields: &[&str]| {
        for field in fields {
            assert!(stats[part].get(field).is_some(), "{part}.{field}: {}", stats[part]);
        }
    };
    has("input", &["path", "vertices", "triangles", "bbox", "diagonal", "closed", "manifold", "components"]);
    has("settings", &["distance", "voxel", "resolution", "sign", "threads", "half_width"]);
    has("phases", &["load", "clean", "hierarchy", "band", "edges", "contour", "write"]);
    has(
        "filter",
        &[
            "nodes_total",
            "bounding_box_queries",
            "signed_distance_rejected",
            "octree_queries_valid",
            "octree_queries_invalid",
            "node_queries",
            "valid_nodes",
        ],
    );
    has("edges", &["intersected", "by_subdivision", "bisected", "queries"]);
    has(
        "contour",
        &[
            "cells",
            "several_sheets",
            "quads",
            "diagonal",
            "split",
            "face_vertices",
            "clamped",
            "vertices",
            "triangles",
        ],
    );
    has("vdb", &["active_voxels", "leaves", "memory"]);
    assert_eq!(stats["edges"]["by_subdivision"].as_array().unwrap().len(), 7);
    let settings = &stats["settings"];
    assert_eq!((&settings["distance"], &settings["voxel"]), (&(-0.125).into(), &0.0625.into()));
    assert_eq!((&settings["threads"], &settings["sign"]), (&2.into(), &"closed".into()));
    assert!(settings["resolution"].is_null());
    let phases = stats["phases"].as_object().unwrap().values().map(|t| t.as_f64().unwrap()).sum::<f64>();
    assert!(stats["wall"].as_f64().unwrap() >= phases);
}

#[test]
fn an_output_may_replace_the_input_and_a_failure_leaves_it() {
    let dir = tempfile::tempdir().unwrap();
    let path = model(dir.path(), "box", "4");
    let before = fs::read(&path).unwrap();
    exocarp(&["offset", &path, "-d", "-5", "--resolution", "16", "-o", &path]).fails_with(4);
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(
        exocarp(&["offset", &path, "-d", "0.1", "--resolution", "16", "-o", &path, "--quiet"]).code,
        0
    );
    assert_ne!(fs::read(&path).unwrap(), before);
    assert_eq!(names(dir.path()), ["box.ply"]);
}

#[test]
fn an_empty_result_says_how_deep_the_model_is() {
    let dir = tempfile::tempdir().unwrap();
    let (input, output) = (model(dir.path(), "box", "4"), dir.path().join("out.ply"));
    let outcome = exocarp(&["offset", &input, "-d", "-50%", "-o", output.to_str().unwrap()]);
    outcome.fails_with(4);
    // Half the side of the box.
    assert!(outcome.stderr.contains("the model is at most 1 deep"), "{}", outcome.stderr);
}

#[test]
fn an_open_mesh_needs_another_sign() {
    let dir = tempfile::tempdir().unwrap();
    let (input, output) = (model(dir.path(), "wave", "8"), dir.path().join("out.ply"));
    let run = |sign| {
        let output = output.to_str().unwrap();
        exocarp(&["offset", &input, "-d", "5%", "--resolution", "32", "-o", output, "--sign", sign])
    };
    let refused = run("closed");
    refused.fails_with(3);
    assert!(refused.stderr.contains("64 boundary edges") && refused.stderr.contains("--sign pseudonormal"));
    let taken = run("pseudonormal");
    assert_eq!(taken.code, 0, "{taken:?}");
    assert!(taken.stderr.starts_with("exocarp: warning: "), "{taken:?}");
}

#[test]
fn too_fine_a_voxel_is_refused_before_the_work() {
    let dir = tempfile::tempdir().unwrap();
    let (input, output) = (model(dir.path(), "box", "4"), dir.path().join("out.ply"));
    let output = output.to_str().unwrap();
    // The work itself would fill any memory, and not end.
    exocarp(&["offset", &input, "-d", "1%", "--voxel", "1e-6", "-o", output]).fails_with(5);
    exocarp(&["offset", &input, "-d", "1%", "-o", output, "--max-memory", "1M"]).fails_with(5);
    assert_eq!(names(dir.path()), ["box.ply"]);
}

#[test]
fn negative_distances_are_taken_as_they_stand() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "box", "4");
    let output = dir.path().join("out.off").display().to_string();
    for distance in [&["-d", "-2%"][..], &["-d=-0.05"], &["-d", "-1e-1"], &["--distance=-3%"], &["-d-0.1"]] {
        let mut all = vec!["offset", input.as_str(), "-o", output.as_str(), "--resolution", "16"];
        all.extend(distance);
        assert_eq!(exocarp(&all).code, 0, "{distance:?}");
    }
}

/// The state of a process, and the ticks of CPU that it took so far (100 in a second).
#[cfg(target_os = "linux")]
fn state_and_ticks(process: u32) -> (char, u64) {
    let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap();
    // The name in parentheses may hold anything.
    let fields: Vec<&str> = stat[stat.rfind(')').unwrap() + 2..].split(' ').collect();
    let ticks = |field: usize| fields[field].parse::<u64>().unwrap();
    (fields[0].chars().next().unwrap(), ticks(11) + ticks(12))
}

#[test]
#[cfg(target_os = "linux")]
fn an_interrupt_stops_within_200_ms_and_leaves_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "carved_cube", "32");
    let output = dir.path().join("out.ply").display().to_string();
    // Some seconds of work, in all profiles.
    let arguments = ["offset", &input, "-d", "5%", "--resolution", "900", "--threads", "2", "-o", &output];
    let child = command(&arguments).spawn().unwrap();
    // Not before it works: a busy machine takes its time to start it.
    let before = loop {
        let (state, ticks) = state_and_ticks(child.id());
        assert!(state != 'Z', "the run ended before it could be interrupted");
        if ticks >= 40 {
            break ticks;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    // Until it is waited for, an ended process is a zombie that still says what it took.
    let after = loop {
        match state_and_ticks(child.id()) {
            ('Z', ticks) => break ticks,
            _ => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    let ended = child.wait_with_output().unwrap();
    assert_eq!(ended.status.code(), Some(130));
    assert_eq!(String::from_utf8_lossy(&ended.stderr), "exocarp: error: interrupted; no file was written\n");
    assert_eq!(names(dir.path()), ["carved_cube.ply"]);
    // 200 ms are promised, which are 20 ticks of each thread; the clock of a busy machine says
    // more.
    assert!(after - before <= 2 * 20, "{} ticks", after - before);
}

#[test]
fn the_same_bytes_for_every_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "anchor", "8");
    let write = |threads| {
        let (mesh, vdb) = (dir.path().join("a.ply"), dir.path().join("a.vdb"));
        let (m, v) = (mesh.to_str().unwrap(), vdb.to_str().unwrap());
        let outcome = exocarp(&[
            "offset",
            &input,
            "-d",
            "-1%",
            "--resolution",
            "64",
            "-o",
            m,
            "--vdb",
            v,
            "--threads",
            threads,
        ]);
        assert_eq!(outcome.code, 0, "{outcome:?}");
        fs::read(mesh).unwrap()
    };
    assert!(write("1") == write("2"), "the meshes differ");
}

#[test]
fn a_tolerance_refines_the_mesh_and_what_is_left_is_counted() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "carved_cube", "6");
    let run = |tolerance: &[&str]| {
        let (output, stats) = (dir.path().join("out.ply"), dir.path().join("out.json"));
        let [output, stats] = [&output, &stats].map(|p| p.to_str().unwrap());
        let mut arguments =
            vec!["offset", &input, "-d", "4%", "--resolution", "24", "-o", output, "--stats", stats];
        arguments.extend(tolerance);
        assert_eq!(exocarp(&arguments).code, 0);
        let json = json(Path::new(stats));
        let voxel = json["settings"]["voxel"].as_f64().unwrap();
        let report = dir.path().join("verify.json");
        let report = report.to_str().unwrap();
        assert_eq!(exocarp(&["verify", &input, output, "-d", "4%", "--json", report]).code, 0);
        let verified = self::json(Path::new(report));
        let worst = verified["distance"]["surface"]["p999"]["units"].as_f64().unwrap() / voxel;
        (json["contour"].clone(), worst)
    };
    let (coarse, coarse_error) = run(&[]);
    let (fine, fine_error) = run(&["--tolerance", "0.02h"]);
    assert!(coarse["beyond_tolerance"].is_null());
    assert!(fine["triangles"].as_u64() > coarse["triangles"].as_u64());
    // Beside creases, splits do not reach everything.
    assert!(fine["beyond_tolerance"].as_u64().unwrap() < fine["triangles"].as_u64().unwrap() / 100);
    assert!(fine_error < 0.025 && coarse_error > 0.03, "{fine_error} {coarse_error}");
    exocarp(&["offset", &input, "-d", "1", "-o", "x.ply", "--tolerance", "0"]).fails_with(2);
}

#[test]
fn what_the_lattice_cannot_see_is_said_and_resolved() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "bracket", "6");
    let (output, stats) = (dir.path().join("out.ply"), dir.path().join("out.json"));
    let [output, stats] = [&output, &stats].map(|p| p.to_str().unwrap());
    let gaps = |more: &[&str]| {
        // Its two holes shrink to less than a voxel.
        let mut arguments =
            vec!["offset", &input, "-d", "0.2", "--voxel", "0.1", "-o", output, "--stats", stats];
        arguments.extend(more);
        let outcome = exocarp(&arguments);
        assert_eq!(outcome.code, 0, "{outcome:?}");
        (json(Path::new(stats)), outcome.stderr)
    };
    let (coarse, warning) = gaps(&[]);
    assert_eq!(coarse["unseen"]["gaps"], 2, "{}", coarse["unseen"]);
    assert!(warning.contains("the result lacks 2 gaps thinner than a voxel"), "{warning}");
    assert!(warning.contains("--resolve"), "{warning}");
    let (fine, warning) = gaps(&["--resolve"]);
    assert_eq!((&fine["unseen"]["gaps"], warning.contains("lacks")), (&0.into(), false), "{warning}");
    assert!(fine["halvings"].as_u64().unwrap() > 0);
    let (_, quiet) = gaps(&["--quiet"]);
    assert!(quiet.is_empty(), "{quiet}");
    exocarp(&["offset", &input, "-d", "0.2", "-o", output, "--resolve=11"]).fails_with(2);
}
