//! Broken files: never a panic, always a mesh that keeps the promises or an error.

use super::*;

/// A file of each kind, small enough to break in every place.
fn files() -> Vec<(Format, Vec<u8>)> {
    let mesh = tetrahedron();
    let ascii = ply_ascii(4, 2, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n");
    let mut big: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_be_bytes).concat();
    big.extend([0, 0, 0, 3, 0, 0, 0, 1, 0, 2, 9]);
    let elements: [(&str, usize, &[&str]); 2] = [
        ("vertex", 3, &["float x", "float y", "float z"]),
        ("face", 1, &["list uint short vertex_index", "uchar material"]),
    ];
    let stl = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid s\n";
    let obj = "v 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 \\\n0\nf 1/1 2/1 3/1 4/1\nf -4 -3 -2\n";
    vec![
        (Format::Obj, written(&mesh, Format::Obj, Precision::F32)),
        (Format::Obj, obj.into()),
        (Format::Off, written(&mesh, Format::Off, Precision::F32)),
        (Format::Ply, written(&mesh, Format::Ply, Precision::F32)),
        (Format::Ply, written(&mesh, Format::Ply, Precision::F64)),
        (Format::Ply, ascii),
        (Format::Ply, ply_file("binary_big_endian", &elements, &big)),
        (Format::Stl, written(&mesh, Format::Stl, Precision::F32)),
        (Format::Stl, stl.into()),
    ]
}

/// Loads the file and checks the result. Whether there was one.
fn check(format: Format, file: &[u8]) -> bool {
    match load_bytes(format, file) {
        Ok(Loaded { mesh, .. }) => {
            assert!(!mesh.triangles.is_empty());
            assert!(mesh.triangles.as_flattened().iter().all(|&v| (v as usize) < mesh.vertices.len()));
            assert!(mesh.vertices.as_flattened().iter().all(|x| x.is_finite()));
            true
        }
        Err(sentence) => {
            let name = format!("model.{}", format.extension());
            assert!(sentence.starts_with(&name) && !sentence.contains('\n'), "{sentence}");
            false
        }
    }
}

#[test]
fn cut_off_at_every_byte() {
    for (format, file) in files() {
        assert!(check(format, &file));
        let loaded = (0..file.len()).filter(|&length| check(format, &file[..length])).count();
        match (format, file.contains(&0)) {
            // A binary file, or one that says where it ends, cannot lose a byte.
            (Format::Ply, true) => assert_eq!(loaded, 0),
            // But for whole triangles: then the number of triangles may as well be what is wrong.
            (Format::Stl, true) => assert_eq!(loaded, 3),
            // But for the line end, and a name.
            (Format::Stl, false) => assert_eq!(loaded, 3),
            // Any line may be the last one.
            (Format::Obj, _) => {}
            // The last number may lose digits, or the line its end.
            _ => assert!(loaded <= 2, "{format} {loaded}"),
        }
    }
}

#[test]
fn every_bit_turned_and_every_byte_replaced() {
    for (format, file) in files() {
        for i in 0..file.len() {
            let mut broken = file.clone();
            for bit in 0..8 {
                broken[i] = file[i] ^ (1 << bit);
                check(format, &broken);
            }
            for byte in *b"09-#\\/ \n\r\0\xff" {
                broken[i] = byte;
                check(format, &broken);
            }
        }
    }
}

#[test]
fn every_byte_missing_or_doubled() {
    for (format, file) in files() {
        for i in 0..file.len() {
            check(format, &[&file[..i], &file[i + 1..]].concat());
            check(format, &[&file[..i], &file[i..i + 1], &file[i..]].concat());
        }
    }
}

#[test]
fn absurd_counts_do_not_allocate() {
    let most = u32::MAX;
    let off = format!("OFF\n{most} {most} 0\n0 0 0\n");
    assert!(sentence(Format::Off, off).contains("of vertex 1 (the header promises 4294967295)"));
    let off = format!("OFF\n1 1 0\n0 0 0\n{} 0 0 0\n", u64::MAX);
    assert!(sentence(Format::Off, off).contains("the file ends before a vertex number of face 0"));
    let ply = ply_ascii(most as usize, usize::MAX, "0 0 0\n");
    assert!(sentence(Format::Ply, ply).contains("of vertex 1 (the header promises 4294967295)"));
    let elements: [(&str, usize, &[&str]); 2] = [
        ("vertex", most as usize, &["float x", "float y", "float z"]),
        ("face", usize::MAX, &["list uint int vertex_indices"]),
    ];
    let ply = ply_file("binary_little_endian", &elements, &[0; 100]);
    assert!(sentence(Format::Ply, ply).contains("vertex 8 (byte"));
    let ply = ply_file("binary_little_endian", &elements[1..], &[0xff; 100]);
    assert!(sentence(Format::Ply, ply).contains("the file ends before the end of this face"));
    let mut stl = written(&tetrahedron(), Format::Stl, Precision::F32);
    stl[80..84].copy_from_slice(&most.to_le_bytes());
    assert_eq!(noted(Format::Stl, &stl).0.triangles.len(), 4);
    stl.pop();
    assert!(sentence(Format::Stl, stl).contains("4294967295 triangles take 214748364834 bytes"));
}
