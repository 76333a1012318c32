//! The body of a binary PLY file, through `ply-rs-bw`, element by element.

use std::io::{BufRead, BufReader, ErrorKind, Read, Seek};

use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::super::error::{LoadErrorKind, Location, ReadError};
use super::super::loaded::NonFinite;
use super::header::{Header, WANTED};
use super::skip::Skipped;
use super::{Body, CORNER_LISTS, Role, Vertex};

/// Reads the body, which is `rest` bytes long.
pub(super) fn read<R: Read + Seek>(
    mut reader: BufReader<R>,
    header: &Header,
    rest: u64,
    body: &mut Body,
) -> Result<(), ReadError> {
    let mut corners = Vec::new();
    for (role, element) in &header.elements {
        // An element without properties takes no bytes, and its count may be anything.
        if element.properties.is_empty() {
            continue;
        }
        body.reserve(*role, element.count as u64, rest, shortest(element));
        for i in 0..element.count as u64 {
            let done = match role {
                Role::Vertex => read_one::<_, Vertex>(&mut reader, header.encoding, element)
                    .map(|vertex| Ok(body.push_vertex(vertex))),
                Role::Face | Role::Strips => read_one::<_, Face>(&mut reader, header.encoding, element)
                    .map(|face| body.push_corners(*role, &face.corners(), &mut corners).map(|()| None)),
                Role::Other => {
                    read_one::<_, Skipped>(&mut reader, header.encoding, element).map(|_| Ok(None))
                }
            };
            let mut location = || -> std::io::Result<Location> {
                let byte = reader.stream_position()?;
                Ok(Location::Element { name: element.name.clone(), number: i, byte })
            };
            let kind = match done {
                Ok(Ok(None)) => continue,
                Ok(Ok(Some(x))) => {
                    if body.non_finite.is_none() {
                        body.non_finite =
                            Some(NonFinite { location: location()?, coordinate: x.to_string() });
                    }
                    continue;
                }
                Ok(Err(kind)) => kind,
                Err(error) => explain(&error, element),
            };
            return Err(ReadError { location: location()?, kind });
        }
    }
    if header.skipped.is_some() && !reader.fill_buf()?.is_empty() {
        return Err(LoadErrorKind::truncated("the end of the body").into());
    }
    Ok(())
}

fn read_one<R: Read, E: PropertyAccess>(
    reader: &mut R,
    encoding: Encoding,
    element: &ElementDef,
) -> Result<E, ParseError> {
    match encoding {
        Encoding::BinaryBigEndian => Parser::<E>::new().read_big_endian_element(reader, element),
        _ => Parser::<E>::new().read_little_endian_element(reader, element),
    }
}

fn explain(error: &ParseError, element: &ElementDef) -> LoadErrorKind {
    match error.kind() {
        ErrorKind::UnexpectedEof => {
            let ElementDef { name, count, .. } = element;
            LoadErrorKind::truncated(format!("the end of this {name} (the header promises {count})"))
        }
        ErrorKind::InvalidInput | ErrorKind::InvalidData => {
            let text = error.to_string();
            let first = text.lines().next().unwrap_or_default();
            let expected = format!("a valid {} ({first})", element.name);
            LoadErrorKind::Syntax { found: "something else".into(), expected }
        }
        kind => LoadErrorKind::Read(kind.into()),
    }
}

/// The fewest bytes that an element takes.
fn shortest(element: &ElementDef) -> u64 {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let sizes = element.properties.values().map(|property| match &property.data_type {
        PropertyType::Scalar(scalar) => size(scalar),
        PropertyType::List(count, _) => size(count),
    });
    sizes.sum()
}

impl Vertex {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        match name {
            "x" => self.position[0] = value,
            "y" => self.position[1] = value,
            "z" => self.position[2] = value,
            WANTED => self.wanted = value,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Vertex::UNKNOWN
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, f64::from(value))
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match property {
            Property::Char(value) => self.set(name, value.into()),
            Property::UChar(value) => self.set(name, value.into()),
            Property::Short(value) => self.set(name, value.into()),
            Property::UShort(value) => self.set(name, value.into()),
            Property::Int(value) => self.set(name, value.into()),
            Property::UInt(value) => self.set(name, value.into()),
            _ => PropertyAccessResult::Ignored,
        }
    }
}

/// The vertex numbers of an element, in a list of the type in the file; the others stay empty.
#[derive(Default)]
struct Face {
    int: Vec<i32>,
    uint: Vec<u32>,
    other: Vec<i64>,
}

impl Face {
    fn corners(self) -> Vec<i64> {
        let Face { int, uint, other } = self;
        int.into_iter().map(i64::from).chain(uint.into_iter().map(i64::from)).chain(other).collect()
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Face::default()
    }

    fn begin_list_int(&mut self, name: &str, _: usize) -> BeginList<'_, i32> {
        if CORNER_LISTS.contains(&name) { BeginList::Fill(&mut self.int) } else { BeginList::UseSetter }
    }

    fn begin_list_uint(&mut self, name: &str, _: usize) -> BeginList<'_, u32> {
        if CORNER_LISTS.contains(&name) { BeginList::Fill(&mut self.uint) } else { BeginList::UseSetter }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !CORNER_LISTS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        // A number that is not whole becomes one that no vertex has.
        let whole = |x: f64| if x == x.trunc() { x as i64 } else { i64::MIN };
        self.other = match property {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListFloat(list) => list.into_iter().map(f64::from).map(whole).collect(),
            Property::ListDouble(list) => list.into_iter().map(whole).collect(),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}
