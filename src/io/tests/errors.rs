//! The sentence that each kind of bad file gets.

use super::*;

#[track_caller]
fn check(format: Format, file: impl AsRef<[u8]>, expected: &str) {
    assert_eq!(sentence(format, file), expected);
}

#[test]
fn files_that_cannot_be_opened() {
    let directory = tempfile::tempdir().unwrap();
    let said = |name: &str| {
        let path = directory.path().join(name);
        let error = TriMesh::load(&path).unwrap_err().to_string();
        let shown = path.display().to_string();
        error.strip_prefix(&shown).expect("the path comes first").to_string()
    };
    let missing = said("missing.obj");
    assert!(missing.starts_with(": the file cannot be opened (No such file or directory"), "{missing}");
    assert!(missing.ends_with("); check the path and the permissions"), "{missing}");
    assert_eq!(said("a.xyz"), ": the extension \"xyz\" is not known; use .obj, .ply, .stl or .off");
    assert_eq!(said("a"), ": the extension \"\" is not known; use .obj, .ply, .stl or .off");
    assert_eq!(
        TriMesh::load("-").unwrap_err().to_string(),
        "-: standard input is not read; save the model as a file and name that"
    );
    std::fs::create_dir(directory.path().join("directory.STL")).unwrap();
    let directory_said = said("directory.STL");
    assert!(directory_said.starts_with(": the file cannot be opened ("), "{directory_said}");
    for format in Format::ALL {
        let name = format!("empty.{}", format.extension());
        std::fs::write(directory.path().join(&name), "").unwrap();
        assert_eq!(said(&name), ": the file is empty; export the model again");
    }
}

/// Opening a pipe that nobody writes to would never end.
#[test]
#[cfg(unix)]
fn pipes_and_devices_are_refused_and_not_waited_for() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let made = std::process::Command::new("mkfifo").arg(path("pipe.ply")).status().unwrap();
    assert!(made.success());
    std::os::unix::fs::symlink("/dev/zero", path("zero.ply")).unwrap();
    for name in ["pipe.ply", "zero.ply"] {
        let error = TriMesh::load(path(name)).unwrap_err().to_string();
        assert!(
            error.ends_with("this is a pipe or a device; save what comes from it as a file and name that")
        );
        let error = vertex_property(&path(name), "x").unwrap_err().to_string();
        assert!(error.contains("this is a pipe or a device"), "{error}");
        let merged = merge_tiles(&[path(name)], &path("whole.ply")).unwrap_err().to_string();
        assert!(merged.contains("this is not a tile"), "{merged}");
    }
}

#[test]
fn files_of_another_format() {
    let says = |format, file: &[u8]| sentence(format, file);
    let end = "); check that the extension fits the content";
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    assert_eq!(
        says(Format::Obj, png),
        format!("model.obj, line 3: this is not OBJ (binary data stands where text belongs{end}")
    );
    assert!(says(Format::Ply, b"OFF\n3 1 0\n").contains("line 1: this is not PLY (it begins with \"OFF\""));
    assert!(says(Format::Stl, b"ply\nformat").contains("this is not STL (it begins with \"ply\\nformat\""));
    let obj = written(&tetrahedron(), Format::Obj, Precision::F32).repeat(2);
    assert!(says(Format::Stl, &obj).contains("this is not STL (it begins with \"v 0 -0 0.3333333432674408"));
    assert!(says(Format::Off, b"solid x\n").contains("line 1: this is not OFF (it begins with \"solid\""));
    assert!(
        says(Format::Off, &written(&tetrahedron(), Format::Stl, Precision::F32)).contains("this is not OFF")
    );
    // Any text is OBJ as far as it goes.
    assert!(says(Format::Obj, b"OFF\n3 1 0\n").contains("the file has no triangles"));
}

#[test]
fn files_without_triangles() {
    let said = "the file has no triangles; export a surface mesh, not points or curves";
    for (format, file) in [
        (Format::Obj, b"v 0 0 0\nl 1 1\n".to_vec()),
        (Format::Ply, ply_ascii(1, 0, "0 0 0\n")),
        (Format::Off, b"OFF\n1 0 0\n0 0 0\n".to_vec()),
        (Format::Stl, b"solid\nendsolid\n".to_vec()),
        (Format::Stl, vec![b' '; 80].into_iter().chain([0; 4]).collect()),
    ] {
        check(format, file, &format!("model.{}: {said}", format.extension()));
    }
}

#[test]
fn coordinates_that_are_not_finite() {
    let what =
        |x: &str| format!("the coordinate {x} is not finite; repair the model in the program that made it");
    check(
        Format::Obj,
        "# a\nv 0 0 0\nv 1 \\\nnan 0\nf 1 2 2\n",
        &format!("model.obj, line 4: {}", what("\"nan\"")),
    );
    check(
        Format::Obj,
        "v 0 0 0\nv 1e999 0 0\nf 1 2 2\n",
        &format!("model.obj, line 2: {}", what("\"1e999\"")),
    );
    check(
        Format::Off,
        "OFF\n1 1 0\n0 -inf 0\n3 0 0 0\n",
        &format!("model.off, line 3: {}", what("\"-inf\"")),
    );
    check(
        Format::Ply,
        ply_ascii(1, 1, "0 0 nan\n3 0 0 0\n"),
        &format!("model.ply, line 10: {}", what("\"nan\"")),
    );
    let stl = "solid\nfacet normal 0 0 1\nouter loop\nvertex inf 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
        endfacet\nendsolid\n";
    check(Format::Stl, stl, &format!("model.stl, line 4: {}", what("\"inf\"")));

    let mut stl = written(&tetrahedron(), Format::Stl, Precision::F32);
    for t in 1..4 {
        stl[84 + 50 * t + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    }
    stl[84 + 20..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    check(Format::Stl, stl, &format!("model.stl, triangle 0 (byte 84): {}", what("inf")));
    let mut ply = written(&tetrahedron(), Format::Ply, Precision::F64);
    let body = ply.len() - 4 * 24 - 4 * 13;
    for v in 1..3 {
        ply[body + 24 * v..][..8].copy_from_slice(&f64::INFINITY.to_le_bytes());
    }
    check(Format::Ply, ply, &format!("model.ply, vertex 1 (byte {}): {}", body + 48, what("inf")));
}

#[test]
fn vertex_numbers_out_of_range() {
    let what = |found: &str, range: &str| {
        format!("a face names vertex \"{found}\", but the vertices are {range}; repair the model")
    };
    let obj = "v 0 0 0\nv 1 0 0\nf 1 2 1\n\nf 1/1 ";
    for found in ["3", "0", "-3", "99999999999"] {
        check(
            Format::Obj,
            format!("{obj}{found}/2 2\n"),
            &format!("model.obj, line 5: {}", what(found, "1 to 2")),
        );
    }
    let off = |found| format!("OFF\n2 1 0\n0 0 0\n0 0 0\n3 0 {found} 1\n");
    let ply = |found| ply_ascii(2, 1, &format!("0 0 0\n0 0 0\n3 0 {found} 1\n"));
    for found in ["2", "-1", "9999999999"] {
        check(Format::Off, off(found), &format!("model.off, line 5: {}", what(found, "0 to 1")));
        check(Format::Ply, ply(found), &format!("model.ply, line 12: {}", what(found, "0 to 1")));
    }
    let mut ply = written(&tetrahedron(), Format::Ply, Precision::F32);
    let length = ply.len();
    ply[length - 4..].copy_from_slice(&4i32.to_le_bytes());
    check(Format::Ply, ply, &format!("model.ply, face 3 (byte {length}): {}", what("4", "0 to 3")));
}

#[test]
fn files_that_were_cut_off() {
    let end = "it was cut off, get a complete copy";
    check(
        Format::Off,
        "OFF\n2 1 0\n0 0 0\n0 0",
        &format!(
            "model.off, line 4: the file ends before a coordinate of vertex 1 (the header promises 2); {end}"
        ),
    );
    check(
        Format::Ply,
        ply_ascii(1, 2, "0 0 0\n3 0 0 0\n3 0"),
        &format!(
            "model.ply, line 12: the file ends before a vertex number of face 1 (the header promises 2); {end}"
        ),
    );
    check(
        Format::Ply,
        "ply\nformat ascii 1.0\nelement vertex 5\n",
        &format!("model.ply, line 4: the file ends before \"end_header\"; {end}"),
    );
    let ply = written(&tetrahedron(), Format::Ply, Precision::F32);
    check(
        Format::Ply,
        &ply[..ply.len() - 1],
        &format!(
            "model.ply, face 3 (byte {}): the file ends before the end of this face (the header promises 4); {end}",
            ply.len() - 1
        ),
    );
    check(
        Format::Stl,
        "solid\nfacet normal 0 0 1\nouter loop\n",
        &format!("model.stl, line 3: the file ends before \"vertex\" or \"endloop\"; {end}"),
    );
    let stl = written(&tetrahedron(), Format::Stl, Precision::F32);
    check(
        Format::Stl,
        &stl[..200],
        &format!(
            "model.stl, byte 200: the file ends before its last triangle (4 triangles take 284 bytes, the file has 200); {end}"
        ),
    );
}

#[test]
fn lines_that_make_no_sense() {
    let end = "belongs; correct it or export the model again";
    check(
        Format::Obj,
        "v 0 0 0\nv 1 O 0 # oh\n",
        &format!("model.obj, line 2: \"v 1 O 0\" stands where a vertex \"v x y z\" {end}"),
    );
    check(
        Format::Obj,
        "v 0 0 0\nf 1 1 x\n",
        &format!(
            "model.obj, line 2: \"f 1 1 x\" stands where a face \"f i j k\" of whole vertex numbers {end}"
        ),
    );
    check(
        Format::Obj,
        "v 0 0 0\nf 1 1\n",
        &format!("model.obj, line 2: \"f 1 1\" stands where a face of three or more corners {end}"),
    );
    check(
        Format::Off,
        "OFF\n1 1 0\n0 0 zero\n",
        &format!("model.off, line 3: \"zero\" stands where a coordinate {end}"),
    );
    check(
        Format::Off,
        "OFF\n1 1 0\n0 0 0\n-3 0 0 0\n",
        &format!("model.off, line 4: \"-3\" stands where a number of corners {end}"),
    );
    check(
        Format::Ply,
        "ply\nformat ascii 1.0\ncomment x\nelement vertex many\nend_header\n",
        &format!(
            "model.ply, line 4: \"element vertex many\" stands where a PLY header line (format, element, property) {end}"
        ),
    );
    check(
        Format::Ply,
        ply_file("ascii", &[("vertex", 1, &["float x", "float x"])], b""),
        &format!(
            "model.ply, line 5: \"property float x\" stands where a name that was not used before {end}"
        ),
    );
    check(
        Format::Stl,
        "solid\nfaced normal 0 0 1\n",
        &format!("model.stl, line 2: \"faced\" stands where \"facet\" or \"endsolid\" {end}"),
    );
}

#[test]
fn variants_that_are_not_supported() {
    check(
        Format::Off,
        "OFF BINARY\n\0\0\0\x04",
        "model.off, line 1: the binary variant of OFF is not supported; save as text or as .ply",
    );
    check(
        Format::Off,
        "4OFF\n1 1 0\n",
        "model.off, line 1: the OFF variant \"4OFF\" is not supported; save with three coordinates a vertex",
    );
    check(
        Format::Ply,
        ply_file("ascii", &[("vertex", 1, &["float x", "float y"])], b"0 0\n"),
        "model.ply, line 6: a vertex without the coordinate \"z\" is not supported; export the mesh again",
    );
    check(
        Format::Ply,
        ply_file("ascii", &[("face", 1, &["list uchar int corners"])], b"0\n"),
        "model.ply, line 5: a face without the list \"vertex_indices\" is not supported; export the mesh again",
    );
}

#[test]
fn meshes_that_a_file_cannot_hold() {
    let directory = tempfile::tempdir().unwrap();
    let said = |mesh: &TriMesh, name: &str, coordinates| {
        let path = directory.path().join(name);
        let error = save(mesh, &path, &SaveOptions { precision: coordinates }).unwrap_err();
        assert!(!path.exists());
        error.kind.to_string()
    };
    let mut mesh = tetrahedron();
    assert!(said(&mesh, "a.txt", Precision::F32).starts_with("the extension \"txt\" is not known"));
    mesh.vertices[2][1] = 1e300;
    for name in ["a.ply", "a.stl"] {
        let said = said(&mesh, name, Precision::F32);
        assert!(said.starts_with("vertex 2 at [-2.5, 1e300, 0.0] does not fit the number type"), "{said}");
    }
    save(&mesh, &directory.path().join("b.ply"), &SaveOptions { precision: Precision::F64 }).unwrap();
    mesh.vertices[2][1] = f64::NAN;
    assert!(said(&mesh, "a.obj", Precision::F64).starts_with("vertex 2 at"));
    mesh = tetrahedron();
    mesh.triangles[1][2] = 4;
    assert!(said(&mesh, "a.off", Precision::F64).starts_with("triangle 1 names a vertex"));
}
