//! The program without the engine: help, exit codes, error sentences, models, info.

mod common;

use common::{Outcome, exocarp, names};
use std::fs;

#[test]
fn help_and_version_are_for_stdout() {
    for arguments in [
        &["--help"][..],
        &["offset", "--help"],
        &["model", "--help"],
        &["info", "--help"],
        &["paper", "--help"],
    ] {
        let help = exocarp(arguments);
        assert_eq!(help.code, 0, "{arguments:?}");
        assert!(help.stdout.contains("Examples:"), "{arguments:?}: {}", help.stdout);
        assert!(help.stderr.is_empty());
    }
    let version = exocarp(&["--version"]);
    assert_eq!(version.stdout.trim(), concat!("exocarp ", env!("CARGO_PKG_VERSION")));
    assert_eq!(exocarp(&[]).code, 2);
}

#[test]
fn wrong_use_is_exit_2_and_one_sentence() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name).display().to_string();
    let (input, output, nowhere) = (at("in.ply"), at("out.ply"), at("no/such/out.ply"));
    fs::write(&input, "never read").unwrap();
    let offset = |rest: &[&str]| {
        let mut all = vec!["offset", input.as_str()];
        all.extend(rest);
        exocarp(&all)
    };
    for rest in [
        &["-d", "1"][..],
        &["-o", &output],
        &["-d", "two", "-o", &output],
        &["-d", "nan", "-o", &output],
        &["-d", "inf%", "-o", &output],
        &["-d", "1", "-o", &output, "--voxel", "0"],
        &["-d", "1", "-o", &output, "--voxel", "-0.5"],
        &["-d", "1", "-o", &output, "--voxel", "nan"],
        &["-d", "1", "-o", &output, "--resolution", "0"],
        &["-d", "1", "-o", &output, "--voxel", "0.1", "--resolution", "9"],
        &["-d", "1", "-o", &output, "--sign", "guess"],
        &["-d", "1", "-o", &output, "--half"],
        &["-d", "1", "-o", &output, "--vdb", &at("band.txt")],
        &["-d", "1", "-o", &output, "--stats", &output],
        &["-d", "1", "-o", &output, "--threads", "0"],
        &["-d", "1", "-o", &output, "--max-memory", "lots"],
        &["-d", "1", "-o", &output, "--quiet", "-v"],
        &["-d", "1", "-o", &at("out.xyz")],
        &["-d", "1", "-o", &at("out.stl"), "--f64"],
        &["-d", "1", "-o", &nowhere],
        &["-d", "1", "-o", dir.path().to_str().unwrap()],
    ] {
        offset(rest).fails_with(2);
    }
    exocarp(&["paper", "--table", "8"]).fails_with(2);
    exocarp(&["model", "teapot", "-o", &output]).fails_with(2);
    exocarp(&["model", "box"]).fails_with(2);
    assert_eq!(names(dir.path()), ["in.ply"]);
}

#[test]
fn sentences_name_the_culprit_and_the_remedy() {
    let says = |arguments: &[&str], parts: &[&str]| {
        let stderr = exocarp(arguments).stderr;
        for part in parts {
            assert!(stderr.contains(part), "{arguments:?}: {stderr}");
        }
    };
    says(&["offset", "a.ply", "-d", "1", "-o", "b.xyz"], &["b.xyz", ".obj"]);
    says(&["offset", "a.ply", "-d", "1", "-o", "no/such/b.ply"], &["no/such", "create it"]);
    says(&["offset", "a.ply", "-d", "1"], &["--output"]);
    says(&["model", "teapot", "-o", "a.ply"], &["teapot", "exocarp model"]);
    says(&["info", "no-such-file.stl"], &["no-such-file.stl"]);
}

#[test]
#[cfg(unix)]
fn a_directory_without_permission_is_found_out_before_the_work() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().unwrap();
    fs::set_permissions(dir.path(), fs::Permissions::from_mode(0o555)).unwrap();
    let output = dir.path().join("out.ply");
    // The superuser may write everywhere.
    if fs::write(&output, "").is_err() {
        let outcome = exocarp(&["offset", "missing.ply", "-d", "1", "-o", output.to_str().unwrap()]);
        outcome.fails_with(2);
        assert!(outcome.stderr.contains("cannot be written"), "{}", outcome.stderr);
    }
    fs::set_permissions(dir.path(), fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn bad_input_is_exit_3() {
    let dir = tempfile::tempdir().unwrap();
    let output = dir.path().join("out.ply").display().to_string();
    for (name, content) in [
        ("empty.stl", ""),
        ("truncated.off", "OFF\n8 12 0\n0 0 0\n"),
        ("nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        ("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("picture.ply", "P6 640 480 255\n"),
        ("letter.vdb", "dear reader"),
    ] {
        let path = dir.path().join(name).display().to_string();
        fs::write(&path, content).unwrap();
        let outcome = exocarp(&["info", &path]);
        outcome.fails_with(3);
        assert!(outcome.stderr.contains(name), "{}", outcome.stderr);
        exocarp(&["offset", &path, "-d", "1%", "-o", &output]).fails_with(3);
    }
    exocarp(&["offset", "no-such-file.ply", "-d", "1", "-o", &output]).fails_with(3);
    assert!(!fs::exists(&output).unwrap());
}

#[test]
fn models_are_listed_and_written() {
    let list = exocarp(&["model"]);
    assert_eq!(list.code, 0);
    let dir = tempfile::tempdir().unwrap();
    for shape in exocarp::shapes::ALL {
        assert!(list.stdout.contains(shape.name), "{}", shape.name);
        let path = dir.path().join(format!("{}.ply", shape.name));
        let model = exocarp(&["model", shape.name, "-o", path.to_str().unwrap(), "--detail", "4", "--f64"]);
        assert_eq!((model.code, model.stderr.as_str()), (0, ""), "{}", shape.name);
        let mesh = exocarp::TriMesh::load(&path).unwrap();
        assert_eq!(mesh, (shape.make)(4), "{}", shape.name);
    }
    assert_eq!(names(dir.path()).len(), exocarp::shapes::ALL.len());
}

#[test]
fn quiet_is_quiet_and_names_may_have_hyphens() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("cube.off").display().to_string();
    let model = exocarp(&["model", "carved-cube", "-o", &path, "--quiet", "--threads", "1"]);
    assert_eq!((model.code, model.stdout.as_str(), model.stderr.as_str()), (0, "", ""));
    assert!(fs::metadata(&path).unwrap().len() > 10_000);
}

#[test]
fn info_knows_a_box() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("box.stl").display().to_string();
    assert_eq!(exocarp(&["model", "box", "-o", &path, "--detail", "2"]).code, 0);
    let text = exocarp(&["info", &path]);
    assert_eq!(text.code, 0);
    assert!(text.stdout.contains("volume              8\n"), "{}", text.stdout);
    let json: serde_json::Value = serde_json::from_str(&exocarp(&["info", &path, "--json"]).stdout).unwrap();
    assert_eq!(json["triangles"], 192);
    assert_eq!(json["vertices"], 98);
    assert_eq!(json["bbox"], serde_json::json!([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]));
    assert_eq!(
        (&json["closed"], &json["manifold"], &json["components"]),
        (&true.into(), &true.into(), &1.into())
    );
    assert!((json["area"].as_f64().unwrap() - 24.0).abs() < 1e-9);
}

#[test]
fn info_has_no_volume_for_an_open_patch() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("wave.obj").display().to_string();
    assert_eq!(exocarp(&["model", "wave", "-o", &path, "--detail", "4"]).code, 0);
    let Outcome { stdout, .. } = exocarp(&["info", &path, "--json"]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&json["closed"], &json["boundary_edges"]), (&false.into(), &32.into()));
    assert!(json["volume"].is_null());
}

#[test]
fn completions_are_scripts() {
    assert!(exocarp(&["completions", "bash"]).stdout.contains("_exocarp()"));
}
