//! Tests across the formats: what is tolerated, what each error says, broken files, round trips.

mod broken;
mod errors;
mod passed;
mod round_trip;
mod tolerance;

use std::io::Cursor;
use std::path::PathBuf;

use super::error::*;
use super::load::{read, vertex_property};
use super::loaded::*;
use super::*;
use crate::mesh::TriMesh;
use crate::quantity::Precision;

/// Loads a file with this content; the error as a user sees it, for a file `model.<extension>`.
fn load_bytes(format: Format, bytes: &[u8]) -> Result<Loaded, String> {
    let path = PathBuf::from(format!("model.{}", format.extension()));
    let loaded = read(Cursor::new(bytes), format).and_then(|content| content.finish(&path));
    loaded.map_err(|ReadError { location, kind }| {
        LoadError { path, format: Some(format), location, kind }.to_string()
    })
}

/// Loads a file that is in order.
fn good(format: Format, bytes: impl AsRef<[u8]>) -> TriMesh {
    let Loaded { mesh, left_out, notes } = load_bytes(format, bytes.as_ref()).unwrap();
    assert_eq!((left_out.as_slice(), notes.as_slice()), (&[][..], &[][..]));
    mesh
}

/// Loads a file that is read with one note: the mesh and the note.
fn noted(format: Format, bytes: impl AsRef<[u8]>) -> (TriMesh, String) {
    let Loaded { mesh, notes, .. } = load_bytes(format, bytes.as_ref()).unwrap();
    let [note] = notes.as_slice() else { panic!("one note, not {notes:?}") };
    (mesh, note.to_string())
}

/// The sentence about a file that is not in order.
fn sentence(format: Format, bytes: impl AsRef<[u8]>) -> String {
    load_bytes(format, bytes.as_ref()).unwrap_err()
}

/// A tetrahedron whose coordinates need all digits of an f32.
fn tetrahedron() -> TriMesh {
    let third = f64::from(1.0f32 / 3.0);
    TriMesh {
        vertices: vec![
            [0.0, -0.0, third],
            [1e-20f32.into(), 0.0, 0.0],
            [-2.5, 1e10, 0.0],
            [0.0, 7.0, -third],
        ],
        triangles: vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]],
    }
}

/// The content of the file that `mesh` is written to.
fn written(mesh: &TriMesh, format: Format, coordinates: Precision) -> Vec<u8> {
    let mut bytes = Vec::new();
    match format {
        Format::Obj => obj::write(mesh, coordinates, &mut bytes),
        Format::Ply => ply::write(mesh, coordinates, &mut bytes),
        Format::Stl => stl::write(mesh, &mut bytes),
        Format::Off => off::write(mesh, coordinates, &mut bytes),
    }
    .unwrap();
    bytes
}

/// A PLY file of the given format line, elements (name, count, properties) and body.
fn ply_file(format: &str, elements: &[(&str, usize, &[&str])], body: &[u8]) -> Vec<u8> {
    let mut file = format!("ply\nformat {format} 1.0\n");
    for (name, count, properties) in elements {
        file += &format!("element {name} {count}\n");
        for property in *properties {
            file += &format!("property {property}\n");
        }
    }
    file += "end_header\n";
    [file.as_bytes(), body].concat()
}

/// The usual elements: `vertices` vertices of three floats, and faces.
fn ply_ascii(vertices: usize, faces: usize, body: &str) -> Vec<u8> {
    let elements: [(&str, usize, &[&str]); 2] = [
        ("vertex", vertices, &["float x", "float y", "float z"]),
        ("face", faces, &["list uchar int vertex_indices"]),
    ];
    ply_file("ascii", &elements, body.as_bytes())
}
