//! The header of a PLY file.
//!
//! `ply-rs-bw` parses it. Comments are taken out before: they may be in any encoding. Properties of
//! no interest get names of their own before, as it refuses names like "distance[<0.1]" and would
//! merge two of the same name. Elements and properties that matter must have different names.
//!
//! Lines that begin with no keyword of PLY are skipped, too: old programs wrote comments without
//! the word. Not those that could be an element or a property with its keyword misspelt, and only
//! if the body fits (see [`read`](super::read)).

use std::collections::HashSet;
use std::io::{BufRead, Read};

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyType};

use super::super::Format;
use super::super::error::{LoadErrorKind, Location, ReadError, quote};
use super::super::loaded::Passed;
use super::super::text::{BYTE_ORDER_MARK, Ended, read_line};
use super::skip::Skipped;
use super::{CORNER_LISTS, Role};

/// The names of the coordinates of a vertex.
pub(super) const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// The name that a property of the user's choice has here.
pub(super) const WANTED: &str = "wanted";

/// The longest header that is read, comments included. Real ones are a few hundred bytes; a file
/// that has no end of the header is not read to its end to find out.
const LONGEST_HEADER: u64 = 1 << 20;

/// The contents of a header.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<(Role, ElementDef)>,
    pub(super) vertex_count: u64,
    /// Length of the header in bytes.
    pub(super) bytes: u64,
    /// Length of the header in lines.
    pub(super) lines: u64,
    /// The lines that were skipped, if any.
    pub(super) skipped: Option<SkippedLines>,
}

/// Lines of a header that begin with no keyword.
#[derive(Clone, Debug)]
pub(super) struct SkippedLines {
    /// The number of the first one.
    line: u64,
    /// The first one, quoted.
    first: String,
    count: usize,
}

impl SkippedLines {
    /// Returns the note for the user.
    pub(super) fn passed(self) -> (Location, Passed) {
        let SkippedLines { line, first, count } = self;
        (Location::Line(line), Passed::HeaderLines { first, lines: count })
    }

    /// Returns the error where the lines should not have been skipped.
    pub(super) fn error(self) -> ReadError {
        let expected = EXPECTED.into();
        LoadErrorKind::Syntax { found: self.first, expected }.on_line(self.line)
    }
}

/// Description of a header's line, for errors.
const EXPECTED: &str = "a PLY header line (format, element, property)";

/// Reads the header; `reader` then stands on the first byte of the body. The scalar property
/// `wanted` of the vertices is named [`WANTED`] in it.
pub(super) fn read<R: BufRead>(reader: &mut R, wanted: Option<&str>) -> Result<Header, ReadError> {
    let mut kept = Kept { wanted: wanted.map(|name| name.as_bytes().to_vec()), ..Kept::default() };
    let (mut bytes, mut lines) = (0u64, 0u64);
    if reader.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
        bytes = BYTE_ORDER_MARK.len() as u64;
        reader.consume(BYTE_ORDER_MARK.len());
    }
    let mut line = Vec::new();
    // All lines end as the first one does: what stands behind the last CR may be data that look
    // like LF.
    let mut end = None;
    loop {
        line.clear();
        let mut rest = reader.by_ref().take(LONGEST_HEADER - bytes);
        let limit = rest.limit();
        match end {
            None => {
                let ended = read_line(&mut rest, LONGEST_HEADER as usize, &mut line)?;
                end = Some(if ended == Some(Ended::Return) { b'\r' } else { b'\n' });
            }
            Some(end) => {
                rest.read_until(end, &mut line)?;
            }
        }
        let read = limit - rest.limit();
        bytes += read;
        lines += 1;
        let words = line.trim_ascii();
        if lines == 1 && words != b"ply" {
            let reason = format!("it begins with {}", quote(words));
            return Err(LoadErrorKind::WrongFormat { format: Format::Ply, reason }.on_line(1));
        }
        if read == 0 {
            return Err(LoadErrorKind::truncated("\"end_header\"").on_line(lines));
        }
        kept.push(words, lines)?;
        // The body begins behind the line end, which a file that was cut off does not have.
        if words == b"end_header" {
            break;
        }
    }
    let header = Parser::<Skipped>::new()
        .read_header(&mut Reader::new(kept.text.as_bytes()))
        .map_err(|error| kept.explain(&error))?;
    let elements: Vec<_> =
        header.elements.into_iter().map(|(_, element)| (role(&element.name), element)).collect();
    let last_line = |kind: LoadErrorKind| kind.on_line(lines);
    for (role, element) in &elements {
        check(*role, element).map_err(last_line)?;
    }
    let vertices = elements.iter().find(|(role, _)| *role == Role::Vertex);
    let vertex_count = vertices.map_or(0, |(_, element)| element.count as u64);
    if u32::try_from(vertex_count).is_err() {
        return Err(last_line(LoadErrorKind::TooManyVertices));
    }
    let skipped = kept.skipped;
    Ok(Header { encoding: header.encoding, elements, vertex_count, bytes, lines, skipped })
}

/// The header without its comments.
#[derive(Default)]
struct Kept {
    text: String,
    /// The line of the file behind each line of `text`: its number and content.
    lines: Vec<(u64, Vec<u8>)>,
    /// The names of the elements, and of the properties of the last one that matter.
    elements: HashSet<Vec<u8>>,
    properties: HashSet<Vec<u8>>,
    /// The name of the property of the vertices that is wanted, and whether the last element is
    /// theirs.
    wanted: Option<Vec<u8>>,
    of_vertices: bool,
    skipped: Option<SkippedLines>,
}

impl Kept {
    fn push(&mut self, line: &[u8], number: u64) -> Result<(), ReadError> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let keyword = words.next().unwrap_or_default();
        let is_new = match keyword {
            b"" | b"comment" | b"obj_info" => return Ok(()),
            b"element" => {
                self.properties.clear();
                let name = words.next().unwrap_or_default();
                self.of_vertices = name == b"vertex";
                self.elements.insert(name.to_vec())
            }
            b"property" => {
                let name = words.next_back().unwrap_or_default();
                if !COORDINATES.iter().chain(&CORNER_LISTS).any(|known| known.as_bytes() == name) {
                    let is_wanted = self.of_vertices && self.wanted.as_deref() == Some(name);
                    let renamed = match is_wanted && self.properties.insert(name.to_vec()) {
                        true => WANTED.to_string(),
                        false => format!("other_{number}"),
                    };
                    let definition = &line[..line.len() - name.len()];
                    return self.keep(line, &[definition, renamed.as_bytes()].concat(), number);
                }
                self.properties.insert(name.to_vec())
            }
            b"ply" | b"format" | b"end_header" => true,
            _ if may_define(line) => return Err(LoadErrorKind::syntax(line, EXPECTED).on_line(number)),
            _ => {
                let new = || SkippedLines { line: number, first: quote(line), count: 0 };
                self.skipped.get_or_insert_with(new).count += 1;
                return Ok(());
            }
        };
        if !is_new {
            return Err(LoadErrorKind::syntax(line, "a name that was not used before").on_line(number));
        }
        self.keep(line, line, number)
    }

    /// Keeps `text` in place of `line`.
    fn keep(&mut self, line: &[u8], text: &[u8], number: u64) -> Result<(), ReadError> {
        let text = std::str::from_utf8(text);
        let text = text.map_err(|_| LoadErrorKind::syntax(line, "a header line").on_line(number))?;
        self.text.push_str(text);
        self.text.push('\n');
        self.lines.push((number, line.to_vec()));
        Ok(())
    }

    /// The line that `ply-rs-bw` does not understand.
    fn explain(&self, error: &ply_rs_bw::parser::ParseError) -> ReadError {
        let line = error.line().and_then(|line| self.lines.get(line.checked_sub(1)?));
        match line {
            Some((number, line)) => LoadErrorKind::syntax(line, EXPECTED).on_line(*number),
            None => LoadErrorKind::syntax(b"end_header", "a line \"format ascii 1.0\" or a binary format")
                .on_line(self.lines.last().map_or(1, |(number, _)| *number)),
        }
    }
}

/// Whether a line that begins with no keyword could be an element ("elemnt face 12") or a property
/// ("propery float x").
fn may_define(line: &[u8]) -> bool {
    const TYPES: &[&str] = &[
        "list", "char", "uchar", "short", "ushort", "int", "uint", "float", "double", "int8", "uint8",
        "int16", "uint16", "int32", "uint32", "float32", "float64",
    ];
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).skip(1);
    let (second, third, more) = (words.next(), words.next(), words.next());
    second.is_some_and(|word| TYPES.iter().any(|name| name.as_bytes() == word))
        || more.is_none() && third.is_some_and(|word| word.iter().all(u8::is_ascii_digit))
}

fn role(name: &str) -> Role {
    match name {
        "vertex" => Role::Vertex,
        "face" => Role::Face,
        "tristrips" => Role::Strips,
        _ => Role::Other,
    }
}

/// Whether the element has what its role needs.
fn check(role: Role, element: &ElementDef) -> Result<(), LoadErrorKind> {
    let unsupported = |what: String| LoadErrorKind::Unsupported { what, remedy: "export the mesh again" };
    let is_scalar = |name: &str| {
        matches!(element.properties.get(name).map(|p| &p.data_type), Some(PropertyType::Scalar(_)))
    };
    let is_list = |name: &&str| {
        matches!(element.properties.get(*name).map(|p| &p.data_type), Some(PropertyType::List(..)))
    };
    match role {
        Role::Vertex => match COORDINATES.into_iter().find(|name| !is_scalar(name)) {
            None => Ok(()),
            Some(name) => Err(unsupported(format!("a vertex without the coordinate \"{name}\""))),
        },
        Role::Face | Role::Strips => match CORNER_LISTS.iter().filter(|name| is_list(name)).count() {
            1 => Ok(()),
            0 => Err(unsupported(format!("a {} without the list \"vertex_indices\"", element.name))),
            _ => Err(unsupported(format!("a {} with two lists of vertices", element.name))),
        },
        Role::Other => Ok(()),
    }
}
