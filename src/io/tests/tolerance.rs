//! Features of files in the wild that the standards do not have, or only in a corner.

use super::*;

const UNIT: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn obj_with_everything_around_the_mesh() {
    let file = b"\xef\xbb\xbf# caf\xe9, not UTF-8\r\nmtllib missing file.mtl\r\no thing\r\n\
        v 0 0 0 1.0\r\nv 1 0 0 0.5 0.5 0.5\r\nv 0 1. 0 1 1 1 1 # a colour with alpha\r\n\
        vt 0\r\nvt 0 0 0\r\nvn 0 0 1\r\nvp 0.5\r\n\
        usemtl\r\ns off\r\ng\r\nf 1/1/1 2//1 \\\r\n  3/2 # continued\r\n\
        g other\r\nv 0 0 1\r\nl 1 2 3\r\np 1\r\ncstype bspline\r\ncurv 0 1 1 2\r\nend\r\n\
        f -4 -1 -3\r\n  f\t1 4 2";
    let mesh = good(Format::Obj, file);
    assert_eq!(mesh.vertices, UNIT);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 1], [0, 3, 1]]);
}

#[test]
fn obj_keeps_unused_vertices_their_order_and_all_digits() {
    let mesh = good(Format::Obj, "v 9 9 9\nv 123456.789 0 0\nv 0 .5 0\nv 8 8 8\nv 0 0 -1e-3\nf 5 3 2\n");
    let vertices =
        [[9.0, 9.0, 9.0], [123456.789, 0.0, 0.0], [0.0, 0.5, 0.0], [8.0, 8.0, 8.0], [0.0, 0.0, -1e-3]];
    assert_eq!(mesh.vertices, vertices);
    assert_eq!(mesh.triangles, [[4, 2, 1]]);
}

#[test]
fn obj_faces_may_come_before_their_vertices_and_be_polygons() {
    let mesh = good(Format::Obj, "f 1 2 3 4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n");
    assert_eq!(mesh.vertices.len(), 4);
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(mesh.corners(0), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
}

#[test]
fn ply_ascii_as_programs_write_it() {
    let mut file = b"ply\r\nformat ascii 1.0\r\ncomment caf\xe9\r\nobj_info\r\n".to_vec();
    file.extend_from_slice(
        b"element vertex 4\r\nproperty float nx\r\nproperty float x\r\nproperty float y\r\n\
        property float z\r\nproperty uchar 3.red[<\xe9]\r\nproperty list uchar float weights\r\n\
        element material 1\r\nproperty int id\r\nproperty int id\r\n\
        element face 2\r\nproperty uchar _f\r\nproperty list uchar int vertex_index\r\n\
        property list uchar float texcoord\r\nelement edge 1\r\nproperty int vertex1\r\nend_header\r\n\
        nan 0 0 0. 255 0\r\n\r\n-inf +1 0 0 255 2 0.5 nan\r\n0 0 1e0 0 255\r\n 0\r\n0 .0 0 1 255 0\r\n\
        7 8\r\n0 3 0 1 2 6 0 0 0 0 0 0\r\n1 3 0 3 1 0\r\n",
    );
    // The edge is missing: the end of a file that no one needs is still missed.
    assert!(sentence(Format::Ply, &file).contains("the file ends before a property of edge 0"));
    file.extend_from_slice(b"5\r\n");
    let mesh = good(Format::Ply, file);
    assert_eq!(mesh.vertices, UNIT);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 1]]);
}

/// A body with every list and number type, in the byte order of `bytes`.
fn ply_binary(order: &str, little: bool) -> Vec<u8> {
    let put = |out: &mut Vec<u8>, bytes: &[u8]| match little {
        true => out.extend_from_slice(bytes),
        false => out.extend(bytes.iter().rev()),
    };
    let mut body = Vec::new();
    for [x, y, z] in UNIT {
        put(&mut body, &7u16.to_le_bytes());
        put(&mut body, &x.to_le_bytes());
        put(&mut body, &(y as i16).to_le_bytes());
        put(&mut body, &2u32.to_le_bytes());
        put(&mut body, &f64::NAN.to_le_bytes());
        put(&mut body, &f64::NAN.to_le_bytes());
        put(&mut body, &(z as f32).to_le_bytes());
    }
    body.extend([3, 0, 1, 2]);
    put(&mut body, &f32::NAN.to_le_bytes());
    body.extend([3, 0, 3, 1]);
    put(&mut body, &f32::NAN.to_le_bytes());
    let vertex = ["ushort a", "double x", "int16 y", "list uint32 float64 b", "float32 z"];
    let face = ["list char uchar vertex_indices", "float quality"];
    ply_file(order, &[("vertex", 4, &vertex), ("face", 2, &face)], &body)
}

#[test]
fn ply_binary_in_both_orders_with_all_types() {
    for (order, little) in [("binary_little_endian", true), ("binary_big_endian", false)] {
        let mut file = ply_binary(order, little);
        file.extend_from_slice(b"bytes behind the end");
        let mesh = good(Format::Ply, file);
        assert_eq!(mesh.vertices, UNIT);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 1]]);
    }
}

#[test]
fn ply_corner_lists_of_every_type() {
    let types: [(&str, usize); 8] = [
        ("char", 1),
        ("uchar", 1),
        ("int16", 2),
        ("ushort", 2),
        ("int", 4),
        ("uint32", 4),
        ("float", 4),
        ("double", 8),
    ];
    for (name, size) in types {
        let mut body = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_be_bytes).concat();
        body.extend([0, 3]);
        for corner in 0..3u8 {
            match (name, size) {
                ("float", _) => body.extend(f32::from(corner).to_be_bytes()),
                ("double", _) => body.extend(f64::from(corner).to_be_bytes()),
                _ => body.extend([vec![0; size - 1], vec![corner]].concat()),
            }
        }
        let list = format!("list ushort {name} vertex_indices");
        let elements: [(&str, usize, &[&str]); 2] =
            [("vertex", 3, &["float x", "float y", "float z"]), ("face", 1, &[&list])];
        assert_eq!(good(Format::Ply, ply_file("binary_big_endian", &elements, &body)).triangles, [[0, 1, 2]]);
    }
}

#[test]
fn ply_faces_before_vertices_strips_and_an_endless_element_of_nothing() {
    let elements: [(&str, usize, &[&str]); 3] = [
        ("nothing", usize::MAX, &[]),
        ("tristrips", 1, &["list int int vertex_indices"]),
        ("vertex", 4, &["double x", "double y", "double z"]),
    ];
    let file = ply_file("ascii", &elements, b"8 0 1 2 3 -1 1 3 2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    let mesh = good(Format::Ply, file);
    assert_eq!(mesh.vertices, UNIT);
    assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [1, 3, 2]]);
}

#[test]
fn polygons_of_few_corners_become_degenerate_and_are_counted() {
    let mesh = good(Format::Ply, ply_ascii(3, 4, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n1 2\n0\n"));
    let (mesh, report) = crate::mesh::clean(mesh);
    assert_eq!((mesh.triangles.len(), report.degenerate_triangles), (1, 2));
}

/// One binary triangle behind a header that begins with `title`.
fn stl_binary(title: &str, count: u32) -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file[..title.len()].copy_from_slice(title.as_bytes());
    file.extend(count.to_le_bytes());
    file.extend([f32::NAN; 3].map(f32::to_le_bytes).concat());
    file.extend([0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat());
    file.extend([0xff, 0xff]);
    file
}

#[test]
fn stl_binary_that_begins_with_solid_or_ends_late() {
    for title in ["solid", "solid facet normal", "something else"] {
        for behind in ["", "x", "endsolid and more"] {
            let file = [&stl_binary(title, 1), behind.as_bytes()].concat();
            let mesh = good(Format::Stl, file);
            assert_eq!(mesh.vertices, UNIT[..3]);
            assert_eq!(mesh.triangles, [[0, 1, 2]]);
        }
    }
}

#[test]
fn stl_ascii_in_any_case_layout_and_number_of_solids() {
    let file = b"\xef\xbb\xbfSOLID caf\xe9 facet\r\n  FACET NORMAL -nan(ind) 0 1\r\n OUTER LOOP\r\n\
        VERTEX 0 0 0\r\nVertex 1.0E+00 0 0\r\nvertex 0 1. 0\r\nendloop endfacet\r\nendsolid\r\n\r\n\
        solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0\n\
        endloop endfacet endsolid again\n";
    let mesh = good(Format::Stl, file);
    assert_eq!(mesh.vertices[..3], UNIT[..3]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5], [3, 5, 6]]);
}

#[test]
fn off_in_its_variants() {
    let faces = "3 0 1 2\n3 0 3 1 255 0 0\n";
    let plain = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    let files = [
        format!("OFF\n4 2 0\n{plain}{faces}"),
        format!("OFF 4 2 5\n{plain}{faces}"),
        format!("4 2 0\n{plain}{faces}"),
        format!("# comment\n\noff # keyword\n# more\n4 2\n\n{plain}\n# faces\n{faces}"),
        format!("OFF\r\n4 2 0\r\n{}{}", plain.replace('\n', " # point\r\n"), faces.replace('\n', "\r\n")),
        format!("COFF\n4 2 0\n{}{faces}", plain.replace('\n', " 255 0 0 255\n")),
        format!("NOFF\n4 2 0\n{}{faces}", plain.replace('\n', " 0 0 nan\n")),
        format!("STCNOFF\n4 2 0\n{}{faces}", plain.replace('\n', " 0 0 1 .5 .5 .5 1 0 0\n")),
        format!("OFF\n4 2 0\n{}{faces}", plain.replace(' ', "\n")),
    ];
    for file in files {
        let mesh = good(Format::Off, &file);
        assert_eq!(mesh.vertices, UNIT, "{file}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 1]], "{file}");
    }
}
