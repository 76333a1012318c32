//! OFF: keyword, counts, vertices, faces.
//!
//! Whatever follows the three coordinates on a vertex's line (normal, colour, texture) and the
//! corners on a face's line (colour) is skipped.

use std::io::{BufReader, Read, Write};

use super::Format;
use super::error::{LoadErrorKind, ReadError, quote};
use super::loaded::Content;
use super::polygon::PolygonMesh;
use super::text::{Text, write_number};
use crate::mesh::TriMesh;
use crate::quantity::Precision;

/// The shortest text of a vertex ("0 0 0" and a line end) and of a face ("0" and a line end): what
/// a file can at most contain is reserved before its content is seen, whatever its header says.
const SHORTEST_VERTEX: u64 = 6;
const SHORTEST_FACE: u64 = 2;

/// Reads a mesh from a file of `length` bytes.
pub(super) fn read<R: Read>(source: R, length: u64) -> Result<Content, ReadError> {
    let reader = BufReader::with_capacity(1 << 16, source);
    let mut text = Text::new(reader, Format::Off, 0).with_comments(b'#');
    let [vertices, faces] = read_header(&mut text)?;
    let mut mesh = PolygonMesh::default();
    mesh.vertices.reserve_exact(vertices.min(length / SHORTEST_VERTEX) as usize);
    for i in 0..vertices {
        let mut vertex = [0.0; 3];
        for x in &mut vertex {
            *x = text.coordinate("a coordinate").map_err(|error| say_which(error, "vertex", i, vertices))?;
        }
        text.skip_rest_of_line();
        mesh.vertices.push(vertex);
    }
    mesh.triangles.reserve_exact(faces.min(length / SHORTEST_FACE / 4) as usize);
    let mut corners = Vec::new();
    for i in 0..faces {
        let cut = |error| say_which(error, "face", i, faces);
        corners.clear();
        for _ in 0..text.count("a number of corners").map_err(cut)? {
            corners.push(read_corner(&mut text, vertices).map_err(cut)?);
        }
        text.skip_rest_of_line();
        mesh.push(&corners);
    }
    Ok(Content { mesh, non_finite: text.take_non_finite(), passed: Vec::new() })
}

/// Reads the keyword and the numbers of vertices and faces.
fn read_header<R: std::io::BufRead>(text: &mut Text<R>) -> Result<[u64; 2], ReadError> {
    let first = text.expect_word("the keyword OFF")?;
    let keyword = text.bytes(first.clone()).to_ascii_uppercase();
    if keyword.ends_with(b"OFF") {
        check_keyword(&keyword).map_err(|kind| text.error(kind))?;
    } else if keyword.iter().all(u8::is_ascii_digit) {
        // The keyword may be missing.
        text.go_back_to(first);
    } else {
        let reason = format!("it begins with {}", quote(text.bytes(first)));
        return Err(text.error(LoadErrorKind::WrongFormat { format: Format::Off, reason }));
    }
    let word = text.expect_word("the number of vertices")?;
    if text.bytes(word.clone()).eq_ignore_ascii_case(b"BINARY") {
        let what = "the binary variant of OFF".into();
        return Err(text.error(LoadErrorKind::Unsupported { what, remedy: "save as text or as .ply" }));
    }
    text.go_back_to(word);
    let vertices = text.count("the number of vertices")?;
    let faces = text.count("the number of faces")?;
    // The number of edges, which may be missing, and which no one keeps right.
    text.skip_rest_of_line();
    match u32::try_from(vertices) {
        Ok(_) => Ok([vertices, faces]),
        Err(_) => Err(text.error(LoadErrorKind::TooManyVertices)),
    }
}

/// Accepts the keywords whose vertices begin with x, y, z: `[ST][C][N]OFF`.
fn check_keyword(keyword: &[u8]) -> Result<(), LoadErrorKind> {
    let rest = &keyword[..keyword.len() - 3];
    let rest = rest.strip_prefix(b"ST").unwrap_or(rest);
    match rest {
        b"" | b"C" | b"N" | b"CN" | b"NC" => Ok(()),
        _ => Err(LoadErrorKind::Unsupported {
            what: format!("the OFF variant {}", quote(keyword)),
            remedy: "save with three coordinates a vertex",
        }),
    }
}

fn read_corner<R: std::io::BufRead>(text: &mut Text<R>, vertices: u64) -> Result<u32, ReadError> {
    let number = text.integer("a vertex number")?;
    match u32::try_from(number) {
        Ok(v) if u64::from(v) < vertices => Ok(v),
        _ => {
            let (found, last) = (quote(number.to_string().as_bytes()), vertices as i64 - 1);
            Err(text.error(LoadErrorKind::VertexNumber { found, first: 0, last }))
        }
    }
}

/// Says at which vertex or face a file was cut off.
fn say_which(mut error: ReadError, name: &str, i: u64, count: u64) -> ReadError {
    if let LoadErrorKind::Truncated { missing } = &mut error.kind {
        *missing = format!("{missing} of {name} {i} (the header promises {count})");
    }
    error
}

/// Writes a mesh.
pub(super) fn write(mesh: &TriMesh, coordinates: Precision, writer: &mut impl Write) -> std::io::Result<()> {
    writeln!(writer, "OFF\n{} {} 0", mesh.vertices.len(), mesh.triangles.len())?;
    for v in &mesh.vertices {
        let [x, y, z] = v.map(|x| coordinates.round(x));
        write_number(x, writer)?;
        writer.write_all(b" ")?;
        write_number(y, writer)?;
        writer.write_all(b" ")?;
        write_number(z, writer)?;
        writer.write_all(b"\n")?;
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(writer, "3 {a} {b} {c}")?;
    }
    Ok(())
}
