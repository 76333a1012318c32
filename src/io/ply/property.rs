//! A number at each vertex, under a name of the user's choice.

use std::io::{BufReader, Read};

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::super::Format;
use super::super::error::{Fault, Problem};

/// The values of the vertices' scalar property `name`, in the order of the file; `None` where there is none. The file
/// must be one that [`read`](super::read) reads: this one trusts what the header says of sizes.
pub(in super::super) fn vertex_property<R: Read>(source: R, name: &str) -> Result<Option<Vec<f64>>, Fault> {
    let mut reader = BufReader::with_capacity(1 << 16, source);
    let file = Parser::<DefaultElement>::new()
        .read_ply(&mut reader)
        .map_err(|e| Problem::WrongFormat { format: Format::Ply, reason: e.to_string() })?;
    let vertices = file.payload.get("vertex").map(Vec::as_slice).unwrap_or_default();
    Ok(vertices.iter().map(|vertex| number(vertex.get(name)?)).collect())
}

fn number(property: &Property) -> Option<f64> {
    Some(match *property {
        Property::Char(x) => x.into(),
        Property::UChar(x) => x.into(),
        Property::Short(x) => x.into(),
        Property::UShort(x) => x.into(),
        Property::Int(x) => x.into(),
        Property::UInt(x) => x.into(),
        Property::Float(x) => x.into(),
        Property::Double(x) => x,
        _ => return None,
    })
}
