//! STL, binary and ascii. Each triangle has its own three vertices; normals are not read.
//!
//! A binary file may begin with "solid", as an ascii one does, so the size decides first: a file of
//! exactly 84 + 50 n bytes, n being the count at byte 80, is binary. Where the size is another one:
//! - Each triangle may be followed by as many bytes as its attributes, a count then, say. They are
//!   stepped over if that fills the file exactly.
//! - A size of 84 + 50 m bytes means m triangles, and the count is wrong: programs that write
//!   triangles as they come leave 0, or the largest number, there. A note says so.
//! - Else bytes behind the last triangle are ignored, and a file that is too short was cut off.

use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;

use super::Format;
use super::error::{LoadErrorKind, Location, ReadError, quote};
use super::loaded::{Content, NonFinite, Passed};
use super::polygon::PolygonMesh;
use super::text::{BYTE_ORDER_MARK, Text};
use crate::mesh::TriMesh;

/// Header and count of a binary file.
pub(super) const HEAD: usize = 84;
/// A triangle of a binary file: normal and corners as twelve f32, and two bytes of attributes.
pub(super) const RECORD: usize = 50;
/// Number of bytes that are looked at to tell text from binary data. A binary file has zero bytes
/// before this, at the latest in its count; an ascii file has none at all.
const PROBE: usize = 1024;

/// Reads a mesh from a file of `length` bytes.
pub(super) fn read<R: Read + Seek>(source: R, length: u64) -> Result<Content, ReadError> {
    let mut reader = BufReader::with_capacity(1 << 16, source);
    let mut probe = Vec::with_capacity(PROBE);
    (&mut reader).take(PROBE as u64).read_to_end(&mut probe)?;
    reader.rewind()?;
    let wrong_format = || {
        let reason = format!("it begins with {}", quote(&probe));
        LoadErrorKind::WrongFormat { format: Format::Stl, reason }
    };
    let text = is_text(&probe);
    let Some(count) = probe.get(80..HEAD).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])) else {
        return if text { read_ascii(reader) } else { Err(wrong_format().into()) };
    };
    let promised = size_of(count.into());
    if promised == length {
        return read_binary(reader, count.into(), Attributes::TwoBytes);
    }
    if text {
        return read_ascii(reader);
    }
    if promised < length && payloads_fill(&mut reader, count, length)? {
        return read_binary(reader, count.into(), Attributes::Counted);
    }
    // Without a zero byte it is some other text, and what stands at byte 80 is no count.
    if promised > length && !probe.contains(&0) {
        return Err(wrong_format().into());
    }
    let found = (length - HEAD as u64) / RECORD as u64;
    if found > 0 && size_of(found) == length {
        let mut content = read_binary(reader, found, Attributes::TwoBytes)?;
        content.passed.push((Location::Byte(80), Passed::Count { said: count, found }));
        return Ok(content);
    }
    if promised > length {
        return Err(ReadError {
            location: Location::Byte(length),
            kind: LoadErrorKind::truncated(format!(
                "its last triangle ({count} triangles take {promised} bytes, the file has {length})"
            )),
        });
    }
    read_binary(reader, count.into(), Attributes::TwoBytes)
}

/// The size of a binary file of so many triangles, in bytes.
fn size_of(triangles: u64) -> u64 {
    HEAD as u64 + RECORD as u64 * triangles
}

/// Whether a file that begins like this is ascii STL.
fn is_text(probe: &[u8]) -> bool {
    let probe = probe.strip_prefix(BYTE_ORDER_MARK).unwrap_or(probe).trim_ascii_start();
    let keyword = probe.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    keyword && !probe.contains(&0)
}

/// Meaning of the last two bytes of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Attributes {
    /// Anything: a colour, mostly zero.
    TwoBytes,
    /// The number of bytes that follow.
    Counted,
}

/// Whether a file of `length` bytes is filled by `count` triangles with as many bytes behind each
/// as its attributes say. The reader is at the beginning afterwards.
fn payloads_fill<R: Read + Seek>(
    reader: &mut BufReader<R>,
    count: u32,
    length: u64,
) -> std::io::Result<bool> {
    let mut end = HEAD as u64;
    reader.seek(SeekFrom::Start(end))?;
    for _ in 0..count {
        end += RECORD as u64;
        if end > length {
            break;
        }
        reader.seek_relative(RECORD as i64 - 2)?;
        let payload = read_attributes(reader)?;
        reader.seek_relative(payload.into())?;
        end += u64::from(payload);
    }
    reader.rewind()?;
    Ok(end == length)
}

fn read_attributes(reader: &mut impl Read) -> std::io::Result<u16> {
    let mut bytes = [0; 2];
    reader.read_exact(&mut bytes)?;
    Ok(u16::from_le_bytes(bytes))
}

/// Reads `count` triangles, which the file is long enough for.
fn read_binary<R: Read + Seek>(
    mut reader: BufReader<R>,
    count: u64,
    attributes: Attributes,
) -> Result<Content, ReadError> {
    let mut byte = HEAD as u64;
    reader.seek(SeekFrom::Start(byte))?;
    let mut content = Content::default();
    let mesh = &mut content.mesh;
    mesh.vertices.reserve_exact(3 * count as usize);
    mesh.triangles.reserve_exact(count as usize);
    let mut record = [0; RECORD];
    for number in 0..count {
        let location = || Location::Element { name: "triangle".into(), number, byte };
        let first = u32::try_from(mesh.vertices.len()).ok().filter(|&v| v < u32::MAX - 3);
        let first =
            first.ok_or_else(|| ReadError { location: location(), kind: LoadErrorKind::TooManyVertices })?;
        reader.read_exact(&mut record)?;
        for corner in record[12..48].as_chunks::<12>().0 {
            let vertex: [f64; 3] = std::array::from_fn(|a| {
                let x = f32::from_le_bytes(std::array::from_fn(|i| corner[4 * a + i]));
                f64::from(x)
            });
            if let Some(x) = vertex.iter().find(|x| !x.is_finite())
                && content.non_finite.is_none()
            {
                content.non_finite = Some(NonFinite { location: location(), coordinate: x.to_string() });
            }
            mesh.vertices.push(vertex);
        }
        mesh.triangles.push([first, first + 1, first + 2]);
        byte += RECORD as u64;
        if attributes == Attributes::Counted {
            let payload = u16::from_le_bytes([record[48], record[49]]);
            reader.seek_relative(payload.into())?;
            byte += u64::from(payload);
        }
    }
    Ok(content)
}

fn read_ascii<R: BufRead>(reader: R) -> Result<Content, ReadError> {
    let mut text = Text::new(reader, Format::Stl, 0);
    let mut mesh = PolygonMesh::default();
    let mut corners: Vec<u32> = Vec::new();
    let mut in_solid = false;
    while let Some(word) = text.word()? {
        if !in_solid {
            // Behind a solid only another one counts, as behind the triangles of a binary file.
            in_solid = is(&mut text, &word, "solid");
            text.skip_rest_of_line();
        } else if is(&mut text, &word, "facet") {
            read_facet(&mut text, &mut mesh, &mut corners)?;
        } else if is(&mut text, &word, "endsolid") {
            in_solid = false;
            text.skip_rest_of_line();
        } else {
            return Err(text.error(LoadErrorKind::syntax(text.bytes(word), "\"facet\" or \"endsolid\"")));
        }
    }
    match in_solid {
        true => Err(text.error(LoadErrorKind::truncated("\"endsolid\""))),
        false => Ok(Content { mesh, non_finite: text.take_non_finite(), passed: Vec::new() }),
    }
}

/// Whether a keyword begins with `word`, in any case. "end solid" is "endsolid", as some programs
/// write.
fn is<R: BufRead>(text: &mut Text<R>, word: &Range<usize>, keyword: &str) -> bool {
    let found = text.bytes(word.clone());
    if found.eq_ignore_ascii_case(keyword.as_bytes()) {
        return true;
    }
    let Some(rest) = keyword.strip_prefix("end").filter(|_| found.eq_ignore_ascii_case(b"end")) else {
        return false;
    };
    let Some(next) = text.word_on_line() else { return false };
    let fits = text.bytes(next.clone()).eq_ignore_ascii_case(rest.as_bytes());
    if !fits {
        text.go_back_to(next);
    }
    fits
}

/// Reads what follows "facet", to "endfacet".
fn read_facet<R: BufRead>(
    text: &mut Text<R>,
    mesh: &mut PolygonMesh,
    corners: &mut Vec<u32>,
) -> Result<(), ReadError> {
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
        if is(text, &word, "endloop") {
            break;
        }
        if !is(text, &word, "vertex") {
            return Err(text.error(LoadErrorKind::syntax(text.bytes(word), "\"vertex\" or \"endloop\"")));
        }
        let number = u32::try_from(mesh.vertices.len()).ok().filter(|&v| v < u32::MAX);
        corners.push(number.ok_or_else(|| text.error(LoadErrorKind::TooManyVertices))?);
        let mut vertex = [0.0; 3];
        for x in &mut vertex {
            *x = text.coordinate("a coordinate")?;
        }
        mesh.vertices.push(vertex);
    }
    mesh.push(corners);
    expect(text, "endfacet")
}

fn expect<R: BufRead>(text: &mut Text<R>, expected: &str) -> Result<(), ReadError> {
    let quoted = format!("\"{expected}\"");
    let word = text.expect_word(&quoted)?;
    match is(text, &word, expected) {
        true => Ok(()),
        false => Err(text.error(LoadErrorKind::syntax(text.bytes(word), quoted))),
    }
}

/// Writes a mesh, binary. Precision are rounded to f32.
pub(super) fn write(mesh: &TriMesh, writer: &mut impl Write) -> std::io::Result<()> {
    writer.write_all(&head(mesh.triangles.len() as u32))?;
    write_triangles((0..mesh.triangles.len()).map(|t| mesh.corners(t)), writer)
}

/// Header and count of a file that is written here.
pub(super) fn head(triangles: u32) -> [u8; HEAD] {
    titled_head(concat!("binary STL written by exocarp ", env!("CARGO_PKG_VERSION")), triangles)
}

/// Makes a header with a title, of which 80 bytes are kept. It must not begin with "solid".
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
