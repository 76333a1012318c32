//! The body of an ascii PLY file.
//!
//! Not through `ply-rs-bw`, whose grammar refuses what files in the wild have: "1." and ".5", "nan"
//! in a property that is of no interest, blank lines, and elements that go on on the next line.

use std::io::BufRead;

use ply_rs_bw::ply::PropertyType;

use super::super::Format;
use super::super::error::{LoadErrorKind, ReadError};
use super::super::text::{Text, is_not_finite, parse};
use super::header::{COORDINATES, Header, WANTED};
use super::{Body, CORNER_LISTS, Role, Vertex};

/// Reads the body, which is `rest` bytes long.
pub(super) fn read<R: BufRead>(
    reader: R,
    header: &Header,
    rest: u64,
    body: &mut Body,
) -> Result<(), ReadError> {
    let mut text = Text::new(reader, Format::Ply, header.lines);
    let mut numbers = Vec::new();
    let mut corners = Vec::new();
    for (role, element) in &header.elements {
        if element.properties.is_empty() {
            continue;
        }
        // A digit and a space for each property.
        body.reserve(*role, element.count as u64, rest, 2 * element.properties.len() as u64);
        for i in 0..element.count as u64 {
            let mut vertex = Vertex::UNKNOWN;
            numbers.clear();
            for (name, property) in &element.properties {
                let done = match property.data_type {
                    PropertyType::Scalar(_) => read_scalar(&mut text, *role, name, &mut vertex),
                    PropertyType::List(..) => read_list(&mut text, *role, name, &mut numbers),
                };
                done.map_err(|error| say_which(error, &element.name, i, element.count))?;
            }
            text.skip_rest_of_line();
            let done = match role {
                Role::Vertex => {
                    body.push_vertex(vertex);
                    Ok(())
                }
                Role::Face | Role::Strips => body.push_corners(*role, &numbers, &mut corners),
                Role::Other => Ok(()),
            };
            done.map_err(|kind| text.error(kind))?;
        }
    }
    body.non_finite = text.take_non_finite();
    if header.skipped.is_some() && text.word()?.is_some() {
        return Err(text.error(LoadErrorKind::truncated("the end of the body")));
    }
    Ok(())
}

fn read_scalar<R: BufRead>(
    text: &mut Text<R>,
    role: Role,
    name: &str,
    vertex: &mut Vertex,
) -> Result<(), ReadError> {
    let is_vertex = role == Role::Vertex;
    if let Some(axis) = COORDINATES.iter().position(|axis| *axis == name && is_vertex) {
        vertex.position[axis] = text.coordinate("a coordinate")?;
        return Ok(());
    }
    let word = text.expect_word("a property")?;
    if is_vertex && name == WANTED {
        let bytes = text.bytes(word);
        vertex.wanted = match parse(bytes) {
            Some(x) => x,
            None if is_not_finite(bytes) => f64::NAN,
            None => return Err(text.error(LoadErrorKind::syntax(bytes, "a number"))),
        };
    }
    Ok(())
}

fn read_list<R: BufRead>(
    text: &mut Text<R>,
    role: Role,
    name: &str,
    numbers: &mut Vec<i64>,
) -> Result<(), ReadError> {
    let wanted = matches!(role, Role::Face | Role::Strips) && CORNER_LISTS.contains(&name);
    for _ in 0..text.count("the length of a list")? {
        match wanted {
            true => numbers.push(text.integer("a vertex number")?),
            false => {
                text.expect_word("a list entry")?;
            }
        }
    }
    Ok(())
}

/// Says at which element a file was cut off.
fn say_which(mut error: ReadError, name: &str, i: u64, count: usize) -> ReadError {
    if let LoadErrorKind::Truncated { missing } = &mut error.kind {
        *missing = format!("{missing} of {name} {i} (the header promises {count})");
    }
    error
}
