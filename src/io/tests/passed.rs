//! Files that are wrong in a way that leaves no doubt of the mesh: they are read, with a note where
//! it may matter.

use super::*;

const TRIANGLE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Text files of one triangle, with LF.
fn texts() -> [(Format, String); 4] {
    let stl = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
        endfacet\nendsolid s\n";
    [
        (Format::Obj, "# one\n#\n\nv 0 0 0 # first\nv 1 0 0\nv 0 1 \\\n0\nf 1 2 \\  \n3\n".into()),
        (Format::Off, "OFF # one\n#\n3 1 0\n0 0 0\n1 0 0\n\n0 1 0\n3 0 1 2\n".into()),
        (Format::Ply, String::from_utf8(ply_ascii(3, 1, "0 0 0\n1 0 0\n\n0 1 0\n3 0 1 2\n")).unwrap()),
        (Format::Stl, stl.into()),
    ]
}

#[test]
fn lines_end_as_on_any_system_and_a_byte_order_mark_may_come_first() {
    for (format, text) in texts() {
        for end in ["\n", "\r\n", "\r", "\r\r\n"] {
            for mark in [&b""[..], b"\xef\xbb\xbf"] {
                let file = [mark, text.replace('\n', end).as_bytes()].concat();
                let mesh = good(format, file);
                assert_eq!(mesh.vertices, TRIANGLE, "{format} {end:?}");
                assert_eq!(mesh.triangles, [[0, 1, 2]], "{format} {end:?}");
            }
        }
    }
}

#[test]
fn lines_are_counted_in_files_with_old_line_ends() {
    for end in ["\n", "\r\n", "\r"] {
        let file = "OFF\n1 1 0\n\n0 0 zero\n".replace('\n', end);
        assert!(sentence(Format::Off, file).starts_with("model.off, line 4: \"zero\""), "{end:?}");
        let file = String::from_utf8(ply_ascii(1, 1, "0 0 zero\n")).unwrap().replace('\n', end);
        assert!(sentence(Format::Ply, file).starts_with("model.ply, line 10: \"zero\""), "{end:?}");
    }
}

/// The first byte of the body is a LF, which belongs to it.
#[test]
fn a_binary_body_begins_behind_the_return() {
    let elements: [(&str, usize, &[&str]); 2] = [
        ("vertex", 3, &["uchar quality", "float x", "float y", "float z"]),
        ("face", 1, &["list uchar uchar vertex_indices"]),
    ];
    let mut body = Vec::new();
    for vertex in TRIANGLE {
        body.push(b'\n');
        body.extend(vertex.map(|x| (x as f32).to_le_bytes()).concat());
    }
    body.extend([3, 0, 1, 2]);
    for end in ["\n", "\r\n", "\r"] {
        let header = String::from_utf8(ply_file("binary_little_endian", &elements, b"")).unwrap();
        for mark in [&b""[..], b"\xef\xbb\xbf"] {
            let file = [mark, header.replace('\n', end).as_bytes(), &body].concat();
            assert_eq!(good(Format::Ply, file).vertices, TRIANGLE, "{end:?}");
        }
    }
}

#[test]
fn header_lines_without_a_keyword_are_skipped_where_the_body_fits() {
    let with = |line: &str, body: &str| {
        let file = String::from_utf8(ply_ascii(3, 1, body)).unwrap();
        file.replace("element face", &format!("{line}\nelement face"))
    };
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let (mesh, note) = noted(Format::Ply, with("Created by Blender3D 2.41, source file: a.blend", body));
    assert_eq!((mesh.vertices.as_slice(), mesh.triangles.as_slice()), (&TRIANGLE[..], &[[0, 1, 2]][..]));
    let said = "is no line of a PLY header and was skipped";
    assert_eq!(
        note,
        format!("model.ply, line 7: \"Created by Blender3D 2.41, source file: a.blend\" {said}")
    );
    let (_, note) = noted(Format::Ply, with("Made by hand\n2005 and later\ncaf\u{e9}", body));
    assert_eq!(
        note,
        "model.ply, line 7: \"Made by hand\" and 2 others are no lines of a PLY header and were skipped"
    );

    // What could be a definition, and a body that is not what the other lines say.
    let expected = "stands where a PLY header line (format, element, property) belongs";
    for (line, body) in [
        ("elemnt edge 1", body),
        ("propery float quality", body),
        ("propery list uchar int neighbours of this", body),
        ("Created by hand", "0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n5 6\n"),
        ("Created by hand", "0 0 0\n1 0 0\n0 1 0\n"),
        ("Created by hand", "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
    ] {
        let said = sentence(Format::Ply, with(line, body));
        assert!(said.starts_with(&format!("model.ply, line 7: \"{line}\" {expected}")), "{said}");
    }
}

#[test]
fn header_lines_are_skipped_before_a_binary_body_of_the_right_size_only() {
    let file = written(&tetrahedron(), Format::Ply, Precision::F32);
    let file = [&b"ply\nMade by hand\n"[..], &file[4..]].concat();
    let (mesh, note) = noted(Format::Ply, &file);
    assert_eq!(mesh.triangles, tetrahedron().triangles);
    assert!(note.starts_with("model.ply, line 2: \"Made by hand\" is no line"), "{note}");
    for wrong in [&[&file[..], b"x"].concat(), &file[..file.len() - 1]] {
        assert!(sentence(Format::Ply, wrong).starts_with("model.ply, line 2: \"Made by hand\" stands where"));
    }
}

#[test]
fn the_end_of_a_solid_may_be_two_words() {
    let file = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        END LOOP\nend facet\nend solid cube\nsolid\nend solid\n";
    assert_eq!(good(Format::Stl, file).triangles, [[0, 1, 2]]);
    let said = sentence(Format::Stl, "solid\nend facet\n");
    assert!(said.starts_with("model.stl, line 2: \"end\" stands where \"facet\" or \"endsolid\""), "{said}");
}

#[test]
fn the_size_of_a_binary_stl_file_says_how_many_triangles_it_has() {
    let file = written(&tetrahedron(), Format::Stl, Precision::F32);
    for said in [0u32, 1, 3, 5, 1000, u32::MAX] {
        let mut wrong = file.clone();
        wrong[80..84].copy_from_slice(&said.to_le_bytes());
        let (mesh, note) = noted(Format::Stl, wrong);
        assert_eq!(mesh, good(Format::Stl, &file));
        let triangles = if said == 1 { "1 triangle" } else { &format!("{said} triangles") };
        let what = format!("the file says that it has {triangles}, but has the size of 4, which were read");
        assert_eq!(note, format!("model.stl, byte 80: {what}"));
    }
}

/// A binary file with `payload` behind each triangle, and its length as attributes.
fn with_payload(mesh: &TriMesh, payload: &[u8]) -> Vec<u8> {
    let file = written(mesh, Format::Stl, Precision::F32);
    let mut with = file[..84].to_vec();
    for record in file[84..].chunks(50) {
        with.extend_from_slice(&record[..48]);
        with.extend((payload.len() as u16).to_le_bytes());
        with.extend_from_slice(payload);
    }
    with
}

#[test]
fn attributes_with_a_payload_are_stepped_over_where_they_fill_the_file() {
    let mesh = tetrahedron();
    let plain = good(Format::Stl, written(&mesh, Format::Stl, Precision::F32));
    // Also one that makes every other record look like a triangle more.
    for length in [1, 6, 50, 255] {
        let file = with_payload(&mesh, &vec![0x41; length]);
        assert_eq!(good(Format::Stl, &file), plain, "{length}");
        // Attributes that are no numbers of bytes: what is behind the last triangle is ignored.
        let mut other = written(&mesh, Format::Stl, Precision::F32);
        other.extend(vec![0x41; length]);
        if length != 50 {
            assert_eq!(good(Format::Stl, &other), plain, "{length}");
        }
    }
}

#[test]
fn vertices_that_are_not_finite_are_left_out_with_their_faces() {
    let obj = "v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1.#INF 0\nv 0 0 1\n\
        f 1 3 4\nf 1 2 3\nf 1 3 4 5 6\nf 1 3 4 6\nf 6 5\\\n 1\nf 4 3 1\n";
    let Loaded { mesh, left_out, notes } = load_bytes(Format::Obj, obj.as_bytes()).unwrap();
    assert_eq!(mesh.vertices, [&TRIANGLE[..], &[[0.0, 0.0, 1.0]]].concat());
    assert_eq!(mesh.triangles.len(), 4);
    assert_eq!((mesh.triangles[0], mesh.triangles[3]), ([0, 1, 2], [2, 1, 0]));
    assert_eq!(left_out, [1, 4]);
    let said = "is not finite; 2 such vertices and 3 faces with them were left out";
    assert_eq!(notes[0].to_string(), format!("model.obj, line 2: the coordinate \"nan\" {said}"));
    assert_eq!(notes.len(), 1);
}

#[test]
fn numbers_that_are_none_are_known_in_every_format() {
    let said = "is not finite; 1 such vertex and 1 face with it were left out";
    for word in ["nan", "-NaN", "inf", "-Infinity", "1e999", "nan(ind)", "-nan(0x8)", "1.#QNAN", "-1.#IND00"]
    {
        let off = format!("OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 {word}\n3 0 1 2\n3 0 1 3\n");
        let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv {word} 0 0\nf 1 2 3\nf 1 2 4\n");
        let ply = ply_ascii(4, 2, &format!("0 0 0\n1 0 0\n0 1 0\n0 {word} 1\n3 0 1 2\n3 0 1 3\n"));
        let facet = |x: &str| {
            format!(
                "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 {x} 0\nendloop\n\
                endfacet\n"
            )
        };
        let stl = format!("solid\n{}{}endsolid\n", facet("1"), facet(word));
        let files = [
            (Format::Off, 6, off.into_bytes()),
            (Format::Obj, 4, obj.into_bytes()),
            (Format::Ply, 13, ply),
            (Format::Stl, 13, stl.into_bytes()),
        ];
        for (format, line, file) in files {
            let (mesh, note) = noted(format, file);
            assert_eq!(mesh.vertices[..3], TRIANGLE);
            assert_eq!(mesh.triangles, [[0, 1, 2]]);
            let place = format!("model.{}, line {line}", format.extension());
            assert_eq!(note, format!("{place}: the coordinate \"{word}\" {said}"));
        }
    }
}

#[test]
fn binary_coordinates_that_are_not_finite_are_left_out() {
    let mesh = tetrahedron();
    let mut stl = written(&mesh, Format::Stl, Precision::F32);
    stl[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    let (found, note) = noted(Format::Stl, stl);
    assert_eq!(found.triangles, [[0, 1, 2], [5, 6, 7], [8, 9, 10]]);
    assert!(
        note.starts_with("model.stl, triangle 1 (byte 134): the coordinate NaN is not finite; 1 such vertex")
    );
    for (coordinates, size) in [(Precision::F32, 4), (Precision::F64, 8)] {
        let mut ply = written(&mesh, Format::Ply, coordinates);
        let body = ply.len() - 4 * 3 * size - 4 * 13;
        // All exponent bits.
        ply[body + 2 * size - 2..][..2].copy_from_slice(&[0xf8, 0x7f]);
        let (found, note) = noted(Format::Ply, ply);
        assert_eq!(found.triangles, [[0, 2, 1]]);
        assert!(note.starts_with(&format!("model.ply, vertex 0 (byte {})", body + 3 * size)), "{note}");
        assert!(note.ends_with("1 such vertex and 3 faces with it were left out"), "{note}");
    }
}

#[test]
fn a_property_is_read_from_any_file_that_is_read() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("map.ply");
    let elements: [(&str, usize, &[&str]); 2] = [
        (
            "vertex",
            2,
            &["float x", "uchar 3.red[<1]", "float y", "double thickness", "float z", "list uchar int a"],
        ),
        ("face", 1, &["int thickness", "list uchar int vertex_indices"]),
    ];
    let body = "0 7 1 0.5 2 0\n3 7 4 1e-3 nan 2 8 9\n4 3 0 0 0\n";
    let file = String::from_utf8(ply_file("ascii", &elements, body.as_bytes())).unwrap();
    for file in [file.clone(), file.replace('\n', "\r"), format!("\u{feff}{file}")] {
        std::fs::write(&path, file).unwrap();
        let values = |name: &str| vertex_property(&path, name).unwrap();
        assert_eq!(values("thickness"), Some(vec![0.5, 1e-3]));
        assert_eq!(values("3.red[<1]"), Some(vec![7.0, 7.0]));
        assert_eq!(values("y"), Some(vec![1.0, 4.0]));
        assert!(values("z").is_some_and(|z| z[0] == 2.0 && z[1].is_nan()));
        assert_eq!([values("a"), values("wanted"), values("other_6")], [None, None, None]);
    }
    let mut binary = Vec::new();
    for x in [1.5f64, 2.5] {
        binary.extend([0; 5]);
        binary.extend([0; 4]);
        binary.extend(x.to_le_bytes());
        binary.extend([0; 5]);
    }
    binary.extend([0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    std::fs::write(&path, ply_file("binary_little_endian", &elements, &binary)).unwrap();
    assert_eq!(vertex_property(&path, "thickness").unwrap(), Some(vec![1.5, 2.5]));
}
