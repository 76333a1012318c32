//! STL, binary and ascii. Each triangle has its own three vertices; normals are not read.
//!
//! A binary file may begin with "solid", as an ascii one does, so the size decides first: a file of
//! exactly 84 + 50 n bytes, n being the count at byte 80, is binary. Bytes behind the last triangle are
//! ignored.

use std::io::{BufRead, BufReader, Read, Seek, Write};

use super::Format;
use super::error::{Fault, Place, Problem, quote};
use super::polygon::PolygonMesh;
use super::text::Text;
use crate::mesh::TriMesh;

/// Header and count of a binary file.
pub(super) const HEAD: usize = 84;
/// A triangle of a binary file: normal and corners as twelve f32, and two bytes of attributes.
pub(super) const RECORD: usize = 50;
/// How much of a file is looked at to tell text from binary data. A binary file has zero bytes before
/// this, at the latest in its count; an ascii file has none at all.
const PROBE: usize = 1024;

/// Reads a mesh from a file of `length` bytes.
pub(super) fn read<R: Read + Seek>(source: R, length: u64) -> Result<TriMesh, Fault> {
    let mut reader = BufReader::with_capacity(1 << 16, source);
    let mut probe = Vec::with_capacity(PROBE);
    (&mut reader).take(PROBE as u64).read_to_end(&mut probe)?;
    reader.rewind()?;
    let count = probe.get(80..HEAD).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let promised = count.map(|n| HEAD as u64 + RECORD as u64 * u64::from(n));
    let text = is_text(&probe);
    match (count, promised) {
        (Some(count), Some(promised)) if promised == length || (!text && promised < length) => {
            read_binary(reader, count)
        }
        _ if text => read_ascii(reader),
        // Without a zero byte it is some other text, and what stands at byte 80 is no count.
        (Some(count), Some(promised)) if probe.contains(&0) => Err(Fault {
            place: Place::Byte(length),
            problem: Problem::truncated(format!(
                "its last triangle ({count} triangles take {promised} bytes, the file has {length})"
            )),
        }),
        _ => {
            let reason = format!("it begins with {}", quote(&probe));
            Err(Problem::WrongFormat { format: Format::Stl, reason }.into())
        }
    }
}

/// Whether a file that begins like this is ascii STL.
fn is_text(probe: &[u8]) -> bool {
    let probe = probe.strip_prefix(b"\xef\xbb\xbf").unwrap_or(probe).trim_ascii_start();
    let keyword = probe.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    keyword && !probe.contains(&0)
}

fn read_binary<R: BufRead>(mut reader: R, count: u32) -> Result<TriMesh, Fault> {
    let mut head = [0; HEAD];
    reader.read_exact(&mut head)?;
    // The size of the file was compared with the count.
    let mut mesh = TriMesh::default();
    mesh.vertices.reserve_exact(3 * count as usize);
    mesh.triangles.reserve_exact(count as usize);
    let mut record = [0; RECORD];
    for t in 0..count {
        let byte = HEAD as u64 + RECORD as u64 * u64::from(t);
        let at = |problem| {
            let place = Place::Element { name: "triangle".into(), number: u64::from(t), byte };
            Fault { place, problem }
        };
        let first = u32::try_from(mesh.vertices.len()).ok().filter(|&v| v < u32::MAX - 3);
        let first = first.ok_or_else(|| at(Problem::TooManyVertices))?;
        reader.read_exact(&mut record)?;
        for corner in record[12..48].as_chunks::<12>().0 {
            let vertex: [f64; 3] = std::array::from_fn(|a| {
                let x = f32::from_le_bytes(std::array::from_fn(|i| corner[4 * a + i]));
                f64::from(x)
            });
            if let Some(x) = vertex.iter().find(|x| !x.is_finite()) {
                return Err(at(Problem::NonFinite(x.to_string())));
            }
            mesh.vertices.push(vertex);
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Ok(mesh)
}

fn read_ascii<R: BufRead>(reader: R) -> Result<TriMesh, Fault> {
    let mut text = Text::new(reader, Format::Stl, 0);
    let mut mesh = PolygonMesh::default();
    let mut corners: Vec<u32> = Vec::new();
    let mut in_solid = false;
    while let Some(word) = text.word()? {
        let keyword = text.bytes(word.clone()).to_ascii_lowercase();
        match (in_solid, keyword.as_slice()) {
            (false, b"solid") => {
                in_solid = true;
                text.skip_rest_of_line();
            }
            (true, b"facet") => read_facet(&mut text, &mut mesh, &mut corners)?,
            (true, b"endsolid") => {
                in_solid = false;
                text.skip_rest_of_line();
            }
            (true, _) => {
                return Err(text.fault(Problem::syntax(text.bytes(word), "\"facet\" or \"endsolid\"")));
            }
            // Behind a solid only another one counts, as behind the triangles of a binary file.
            (false, _) => text.skip_rest_of_line(),
        }
    }
    match in_solid {
        true => Err(text.fault(Problem::truncated("\"endsolid\""))),
        false => Ok(mesh.finish()),
    }
}

/// Reads what follows "facet", to "endfacet".
fn read_facet<R: BufRead>(
    text: &mut Text<R>,
    mesh: &mut PolygonMesh,
    corners: &mut Vec<u32>,
) -> Result<(), Fault> {
    expect(text, "normal")?;
    for _ in 0..3 {
        // Normals that are not numbers are common, and of no use anyway.
        text.expect_word("a component of the normal")?;
    }
    expect(text, "outer")?;
    expect(text, "loop")?;
    corners.clear();
    loop {
        let word = text.expect_word("\"vertex\" or \"endloop\"")?;
        let found = text.bytes(word);
        if found.eq_ignore_ascii_case(b"endloop") {
            break;
        }
        if !found.eq_ignore_ascii_case(b"vertex") {
            return Err(text.fault(Problem::syntax(found, "\"vertex\" or \"endloop\"")));
        }
        let number = u32::try_from(mesh.vertices.len()).ok().filter(|&v| v < u32::MAX);
        corners.push(number.ok_or_else(|| text.fault(Problem::TooManyVertices))?);
        let mut vertex = [0.0; 3];
        for x in &mut vertex {
            *x = text.coordinate("a coordinate")?;
        }
        mesh.vertices.push(vertex);
    }
    mesh.push(corners);
    expect(text, "endfacet")
}

fn expect<R: BufRead>(text: &mut Text<R>, keyword: &str) -> Result<(), Fault> {
    let expected = format!("\"{keyword}\"");
    let word = text.expect_word(&expected)?;
    let found = text.bytes(word);
    match found.eq_ignore_ascii_case(keyword.as_bytes()) {
        true => Ok(()),
        false => Err(text.fault(Problem::syntax(found, expected))),
    }
}

/// Writes a mesh, binary. Coordinates are rounded to f32.
pub(super) fn write(mesh: &TriMesh, writer: &mut impl Write) -> std::io::Result<()> {
    writer.write_all(&head(mesh.triangles.len() as u32))?;
    write_triangles((0..mesh.triangles.len()).map(|t| mesh.corners(t)), writer)
}

/// Header and count of a file that is written here.
pub(super) fn head(triangles: u32) -> [u8; HEAD] {
    titled_head(concat!("binary STL written by exocarp ", env!("CARGO_PKG_VERSION")), triangles)
}

/// The same with another title, of which 80 bytes are kept. It must not begin with "solid".
pub(super) fn titled_head(title: &str, triangles: u32) -> [u8; HEAD] {
    let mut head = [b' '; HEAD];
    let length = title.len().min(80);
    head[..length].copy_from_slice(&title.as_bytes()[..length]);
    head[80..].copy_from_slice(&triangles.to_le_bytes());
    head
}

/// Writes the triangles of a binary file.
pub(super) fn write_triangles(
    triangles: impl IntoIterator<Item = [[f64; 3]; 3]>,
    writer: &mut impl Write,
) -> std::io::Result<()> {
    for corners in triangles {
        let mut record = [0; RECORD];
        let numbers = [unit_normal(corners)].into_iter().chain(corners).flatten();
        for (place, x) in record.chunks_exact_mut(4).zip(numbers) {
            place.copy_from_slice(&(x as f32).to_le_bytes());
        }
        writer.write_all(&record)?;
    }
    Ok(())
}

/// The unit normal of a triangle; zero when its area is.
fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [p, q]: [[f64; 3]; 2] = [b, c].map(|end| std::array::from_fn(|i| end[i] - a[i]));
    let n = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 && length.is_finite() { n.map(|x| x / length) } else { [0.0; 3] }
}
