//! The program and its files: odd inputs, pipes, names that cannot be, permissions, full disks.

mod common;

use common::{Outcome, command, exocarp, names};
use std::fs;
use std::path::Path;
use std::process::Stdio;

/// Writes a model and returns its path.
fn model(dir: &Path, name: &str) -> String {
    let path = dir.join(format!("{name}.stl")).display().to_string();
    assert_eq!(exocarp(&["model", name, "-o", &path, "--detail", "2", "-q"]).code, 0);
    path
}

fn volume(path: &str) -> f64 {
    let Outcome { stdout, .. } = exocarp(&["info", path, "--json"]);
    let json: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    json["volume"].as_f64().unwrap()
}

#[test]
fn what_was_passed_over_in_a_file_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let path = model(dir.path(), "box");
    let mut file = fs::read(&path).unwrap();
    file[80..84].copy_from_slice(&0u32.to_le_bytes());
    fs::write(&path, &file).unwrap();
    let output = dir.path().join("out.ply").display().to_string();
    let said = "byte 80: the file says that it has 0 triangles, but has the size of 192, which were read\n";
    for arguments in [
        &["info", &path][..],
        &["verify", &path, &path, "-d", "0", "--samples", "10"],
        &["offset", &path, "-d", "0.1", "--resolution", "8", "-o", &output],
    ] {
        let outcome = exocarp(arguments);
        assert_eq!(outcome.code, 0, "{outcome:?}");
        let line = outcome.stderr.lines().next().unwrap();
        assert_eq!(format!("{line}\n"), format!("exocarp: warning: {path}, {said}"));
        assert_eq!(exocarp(&[arguments, &["-q"]].concat()).stderr, "");
    }
    assert!((volume(&path) - 8.0).abs() < 1e-6);
}

/// A cube of side 2 with a vertex in the middle of an edge that only one side of it has; the
/// triangle between is flat.
#[test]
fn a_closed_mesh_with_a_flat_triangle_is_offset() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name).display().to_string();
    let (input, output) = (at("cube.off"), at("grown.ply"));
    let corners = "-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n0 1 1\n";
    // The last face but two has the edge from 6 to 7, those with vertex 8 do not.
    let faces =
        "4 0 3 2 1\n4 0 1 5 4\n4 1 2 6 5\n4 3 0 4 7\n3 2 3 7\n3 2 7 6\n3 7 8 6\n3 4 5 8\n3 5 6 8\n3 4 8 7\n";
    fs::write(&input, format!("OFF\n9 10 0\n{corners}{faces}")).unwrap();
    let outcome = exocarp(&["offset", &input, "-d", "0.1", "--resolution", "64", "-o", &output]);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let said = "split 1 triangle at a vertex on its edge, dropped 1 degenerate triangle\n";
    assert_eq!(outcome.stderr, format!("exocarp: warning: {input}: {said}"));
    // Steiner: V + A r + M r^2 + 4/3 pi r^3, with M = 6 pi for a cube of side 2.
    let r = 0.1f64;
    let expected = 8.0 + 24.0 * r + std::f64::consts::PI * (6.0 * r * r + 4.0 / 3.0 * r.powi(3));
    assert!((volume(&output) - expected).abs() < 0.01, "{} {expected}", volume(&output));
}

#[test]
#[cfg(unix)]
fn pipes_and_standard_input_are_refused_and_not_waited_for() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name).display().to_string();
    let (input, mesh, band, map) = (model(dir.path(), "box"), at("pipe.PLY"), at("pipe.vdb"), at("map"));
    for pipe in [&mesh, &band, &map] {
        assert!(std::process::Command::new("mkfifo").arg(pipe).status().unwrap().success());
    }
    let before = names(dir.path());
    let output = at("out.ply");
    for pipe in ["-", &mesh, &band] {
        for arguments in [
            &["info", pipe][..],
            &["offset", pipe, "-d", "1", "-o", &output],
            &["thicken", pipe, "-t", "1", "-o", &output],
            &["verify", &input, pipe, "-d", "1"],
            &["verify", pipe, &input, "-d", "1"],
            &["compare", pipe, "-d", "1"],
            &["merge", pipe, "-o", &output],
        ] {
            exocarp(arguments).fails_with(3);
        }
    }
    for map in ["-", &map, &at("missing"), dir.path().to_str().unwrap()] {
        exocarp(&["thicken", &input, "--thickness-map", map, "-o", &output]).fails_with(3);
    }
    assert!(exocarp(&["info", &mesh]).stderr.contains("this is a pipe or a device; save"));
    assert!(exocarp(&["info", "-"]).stderr.contains("standard input is not read; save"));
    assert_eq!(names(dir.path()), before);
}

#[test]
fn names_that_no_output_can_have_are_wrong_use() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name).display().to_string();
    let (input, good) = (model(dir.path(), "box"), at("good.ply"));
    let before = names(dir.path());
    let long = at(&("a".repeat(300) + ".ply"));
    for wrong in ["-", &format!("{good}/"), &format!("{good}/."), &at("no/such/o.ply"), &long] {
        exocarp(&["offset", &input, "-d", "0.1", "-o", wrong]).fails_with(2);
        exocarp(&["offset", &input, "-d", "0.1", "-o", &good, "--stats", wrong]).fails_with(2);
        exocarp(&["thicken", &input, "-t", "0.1", "-o", wrong]).fails_with(2);
        exocarp(&["model", "box", "-o", wrong]).fails_with(2);
        exocarp(&["merge", &input, "-o", wrong]).fails_with(2);
        exocarp(&["verify", &input, &input, "-d", "0", "--json", wrong]).fails_with(2);
    }
    let said = exocarp(&["model", "box", "-o", &format!("{good}/")]).stderr;
    assert!(said.contains("good.ply/ is the name of a directory; leave out what follows it"), "{said}");
    assert_eq!(names(dir.path()), before);
}

#[test]
fn a_map_has_a_value_for_each_vertex_of_the_file_also_for_those_left_out() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name).display().to_string();
    let thicken = |vertices: &str, faces: &str, map: &str| {
        let (input, values, output) = (at("square.off"), at("map.txt"), at("solid.ply"));
        let count = [vertices.lines().count(), faces.lines().count()];
        fs::write(&input, format!("OFF\n{} {} 0\n{vertices}{faces}", count[0], count[1])).unwrap();
        fs::write(&values, map).unwrap();
        let outcome = exocarp(&["thicken", &input, "--thickness-map", &values, "-o", &output]);
        assert_eq!(outcome.code, 0, "{outcome:?}");
        (fs::read(&output).unwrap(), outcome.stderr)
    };
    let whole = thicken(
        "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n0 0 0\n",
        "3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n",
        "0.3 0.5 0.5 0.3 0.4",
    );
    let with_holes = thicken(
        "nan 0 0\n-1 -1 0\n1 -1 0\n0 inf 0\n1 1 0\n-1 1 0\n0 0 0\n",
        "3 1 2 6\n3 2 4 6\n3 4 5 6\n3 5 1 6\n3 0 1 2\n",
        "7 0.3 0.5 9 0.5 0.3 0.4",
    );
    assert!(whole.0 == with_holes.0);
    assert_eq!(whole.1, "");
    assert!(
        with_holes.1.contains("line 3: the coordinate \"nan\" is not finite; 2 such vertices and 1 face")
    );
}

#[test]
#[cfg(unix)]
fn a_file_that_is_replaced_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let input = model(dir.path(), "box");
    for mode in [0o444, 0o600, 0o664] {
        let outputs = [at("out.ply"), at("out.vdb"), at("out.json")];
        for output in &outputs {
            fs::write(output, "old").unwrap();
            fs::set_permissions(output, fs::Permissions::from_mode(mode)).unwrap();
        }
        let [mesh, vdb, stats] = outputs.each_ref().map(|path| path.to_str().unwrap());
        let more = ["--resolution", "8", "-o", mesh, "--vdb", vdb, "--stats", stats, "-q"];
        let outcome = exocarp(&[&["offset", input.as_str(), "-d", "0.1"], &more[..]].concat());
        assert_eq!((outcome.code, outcome.stderr.as_str()), (0, ""));
        for output in &outputs {
            let meta = fs::metadata(output).unwrap();
            assert!(meta.len() > 3);
            assert_eq!(meta.permissions().mode() & 0o777, mode, "{}", output.display());
            fs::remove_file(output).unwrap();
        }
    }
}

/// The commands that say something on stdout.
fn talking(dir: &Path) -> Vec<Vec<String>> {
    let (input, output) = (model(dir, "box"), dir.join("out.ply").display().to_string());
    [
        &["info", &input][..],
        &["info", &input, "--json"],
        &["verify", &input, &input, "-d", "0", "--samples", "10"],
        &["model"],
        &["model", "box", "-o", &output],
        &["paper", "--table", "1", "--resolution", "8"],
        &["compare", &input, "-d", "0.1", "--resolution", "8", "--runs", "1", "--methods", "exocarp"],
        &["offset", &input, "-d", "0.1", "--resolution", "8", "-o", &output],
        &["--help"],
        &["--version"],
        &["completions", "bash"],
    ]
    .map(|arguments| arguments.iter().map(|a| a.to_string()).collect())
    .into()
}

#[test]
#[cfg(target_os = "linux")]
fn a_text_that_is_lost_is_a_limit_that_was_hit() {
    let dir = tempfile::tempdir().unwrap();
    for arguments in talking(dir.path()) {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let ended = command(&arguments).stdout(full).output().unwrap();
        let stderr = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(5), "{arguments:?}: {stderr}");
        let last = stderr.lines().last().unwrap();
        assert!(last.starts_with("exocarp: error: the text for standard output is lost ("), "{stderr}");
        // What goes to files is there.
        assert_eq!(dir.path().join("out.ply").exists(), arguments.contains(&"-o"), "{arguments:?}");
        let _ = fs::remove_file(dir.path().join("out.ply"));
    }
}

#[test]
fn a_reader_that_went_away_is_no_error() {
    let dir = tempfile::tempdir().unwrap();
    for arguments in talking(dir.path()) {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let mut child = command(&arguments).stdout(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let ended = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(ended.stderr).unwrap();
        assert_eq!((ended.status.code(), stderr.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

/// A file system of 64 KB, unmounted when it is dropped.
#[cfg(target_os = "linux")]
struct Tiny(tempfile::TempDir);

#[cfg(target_os = "linux")]
impl Tiny {
    /// `None` where this user may not mount.
    fn mount() -> Option<Tiny> {
        let dir = tempfile::tempdir().unwrap();
        let mount = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
            .arg(dir.path())
            .stderr(Stdio::null())
            .status();
        mount.is_ok_and(|status| status.success()).then_some(Tiny(dir))
    }
}

#[cfg(target_os = "linux")]
impl Drop for Tiny {
    fn drop(&mut self) {
        let unmounted = std::process::Command::new("umount").arg(self.0.path()).status();
        assert!(unmounted.is_ok_and(|status| status.success()), "{} stays", self.0.path().display());
    }
}

/// Outputs for a place without room for them: arguments behind those of an offset.
fn too_large(dir: &Path) -> Vec<Vec<String>> {
    let at = |name: &str| dir.join(name).display().to_string();
    let (mesh, stl, vdb) = (at("o.ply"), at("o.stl"), at("o.vdb"));
    [
        &["-o", &mesh][..],
        &["-o", &stl, "--stream"],
        &["-o", &mesh, "--stream"],
        &["-o", &mesh, "--tile", "1/1"],
        &["--vdb", &vdb],
        &["--vdb", &vdb, "--vdb-compression", "zip"],
        &["--vdb", &vdb, "--vdb-compression", "none", "--half"],
        &["-o", &mesh, "--vdb", &vdb],
    ]
    .map(|arguments| arguments.iter().map(|a| a.to_string()).collect())
    .into()
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_a_limit_for_every_output() {
    let Some(tiny) = Tiny::mount() else {
        eprintln!("skipped: a_full_disk_is_a_limit_for_every_output (no permission to mount)");
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "box");
    for more in too_large(tiny.0.path()) {
        let mut arguments = vec!["offset", &input, "-d", "0.1", "--resolution", "64"];
        arguments.extend(more.iter().map(String::as_str));
        let outcome = exocarp(&arguments);
        outcome.fails_with(5);
        assert!(outcome.stderr.contains("No space left on device"), "{}", outcome.stderr);
        assert!(outcome.stderr.contains("check the"), "{}", outcome.stderr);
        assert!(names(tiny.0.path()).is_empty(), "{more:?}");
    }
    let tiles: Vec<String> = ["t.vdb", "t.ply"].map(|n| dir.path().join(n).display().to_string()).into();
    let tiled = ["offset", &input, "-d", "0.1", "--resolution", "64", "--tile", "1/1"];
    assert_eq!(exocarp(&[&tiled[..], &["--vdb", &tiles[0], "-o", &tiles[1]]].concat()).code, 0);
    for (tile, whole) in [(&tiles[0], "whole.vdb"), (&tiles[1], "whole.ply")] {
        let whole = tiny.0.path().join(whole).display().to_string();
        exocarp(&["merge", tile, "-o", &whole]).fails_with(5);
    }
    assert!(names(tiny.0.path()).is_empty());
}

/// A full disk, made by a limit on the size of files, which ended the program with a signal.
#[test]
#[cfg(target_os = "linux")]
fn a_limit_on_the_size_of_files_is_one_too() {
    let dir = tempfile::tempdir().unwrap();
    let input = model(dir.path(), "box");
    let before = names(dir.path());
    for more in too_large(dir.path()) {
        // In blocks of 512 bytes, or of 1024.
        let ended = std::process::Command::new("sh")
            .args(["-c", "ulimit -f 16 && exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_exocarp")])
            .args(["offset", &input, "-d", "0.1", "--resolution", "64"])
            .args(&more)
            .output()
            .unwrap();
        let stderr = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(5), "{more:?}: {stderr}");
        assert!(stderr.contains("File too large"), "{stderr}");
        assert_eq!(names(dir.path()), before, "{more:?}");
    }
}
