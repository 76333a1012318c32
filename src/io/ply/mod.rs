//! PLY: the header, the binary body and the ascii body in a file each, and the writer.
//!
//! Read: `x y z` of element `vertex`, the list `vertex_indices` or `vertex_index` of element
//! `face`, and the same list of element `tristrips` (-1 starts a new strip). All else is skipped.
//! Header and binary body go through `ply-rs-bw`. Numbers in an ascii body are taken with all their
//! digits, also where the header calls them `float`.

mod ascii;
mod binary;
mod header;
mod skip;

use std::io::{BufReader, Read, Seek, Write};

use ply_rs_bw::ply::{Encoding, PropertyType};

use super::error::{LoadErrorKind, ReadError, quote};
use super::loaded::{Content, NonFinite};
use super::polygon::PolygonMesh;
use crate::mesh::TriMesh;
use crate::quantity::Precision;
use header::{COORDINATES, Header, WANTED};

/// Reads a mesh from a file of `length` bytes.
///
/// Lines of the header are skipped only where the body is exactly what the others say: then none of
/// them was needed.
pub(super) fn read<R: Read + Seek>(source: R, length: u64) -> Result<Content, ReadError> {
    let mut reader = BufReader::with_capacity(1 << 16, source);
    let header = header::read(&mut reader, None)?;
    let Body { mesh, non_finite, .. } = read_body(reader, &header, length, Wanted::Mesh)?;
    let passed = header.skipped.map(header::SkippedLines::passed);
    Ok(Content { mesh, non_finite, passed: passed.into_iter().collect() })
}

/// The values of the vertices' scalar property `name`, in the order of the file; `None` where there
/// is none.
pub(super) fn vertex_property<R: Read + Seek>(
    source: R,
    length: u64,
    name: &str,
) -> Result<Option<Vec<f64>>, ReadError> {
    let mut reader = BufReader::with_capacity(1 << 16, source);
    let header = header::read(&mut reader, Some(name))?;
    let axis = COORDINATES.iter().position(|axis| *axis == name);
    let name = axis.map_or(WANTED, |axis| COORDINATES[axis]);
    let of_vertices = header.elements.iter().filter(|(role, _)| *role == Role::Vertex);
    let mut properties = of_vertices.filter_map(|(_, element)| element.properties.get(name));
    if !properties.any(|property| matches!(property.data_type, PropertyType::Scalar(_))) {
        return Ok(None);
    }
    let wanted = axis.map_or(Wanted::Property, Wanted::Axis);
    Ok(Some(read_body(reader, &header, length, wanted)?.values))
}

/// Reads the body of a file of `length` bytes.
fn read_body<R: Read + Seek>(
    reader: BufReader<R>,
    header: &Header,
    length: u64,
    wanted: Wanted,
) -> Result<Body, ReadError> {
    let (mesh, vertex_count) = (PolygonMesh::default(), header.vertex_count);
    let mut body = Body { mesh, vertex_count, non_finite: None, wanted, values: Vec::new() };
    let rest = length.saturating_sub(header.bytes);
    let done = match header.encoding {
        Encoding::Ascii => ascii::read(reader, header, rest, &mut body),
        Encoding::BinaryLittleEndian | Encoding::BinaryBigEndian => {
            binary::read(reader, header, rest, &mut body)
        }
    };
    match (done, &header.skipped) {
        (Ok(()), _) => Ok(body),
        (Err(error), Some(skipped)) if !matches!(error.kind, LoadErrorKind::Read(_)) => {
            Err(skipped.clone().error())
        }
        (Err(error), _) => Err(error),
    }
}

/// Role of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// The element's `x`, `y`, `z` are a vertex.
    Vertex,
    /// The element's list of vertex numbers is a face.
    Face,
    /// The element's list of vertex numbers is a sequence of triangle strips.
    Strips,
    /// Nothing.
    Other,
}

/// The names of the list of vertex numbers.
const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The properties of a vertex that are read.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: [f64; 3],
    /// The property [`WANTED`].
    wanted: f64,
}

impl Vertex {
    /// Nothing is known of it.
    const UNKNOWN: Vertex = Vertex { position: [f64::NAN; 3], wanted: f64::NAN };
}

/// The part of a file that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// The mesh alone.
    Mesh,
    /// Also the coordinates along an axis, as they stand there.
    Axis(usize),
    /// Also the property [`WANTED`] of the vertices.
    Property,
}

/// The mesh in the making. The faces may come before the vertices, so numbers are checked against
/// the header.
struct Body {
    mesh: PolygonMesh,
    vertex_count: u64,
    non_finite: Option<NonFinite>,
    wanted: Wanted,
    /// The values of what is wanted, for each vertex.
    values: Vec<f64>,
}

impl Body {
    /// Makes room for `count` elements, but not for more than `rest` bytes of file can hold.
    fn reserve(&mut self, role: Role, count: u64, rest: u64, shortest: u64) {
        let count = count.min(rest / shortest.max(1)) as usize;
        match role {
            Role::Vertex => self.mesh.vertices.reserve_exact(count),
            Role::Face => self.mesh.triangles.reserve_exact(count),
            Role::Strips | Role::Other => {}
        }
    }

    /// Appends a vertex. Returns a coordinate that is not finite, if there is one.
    fn push_vertex(&mut self, Vertex { position, wanted }: Vertex) -> Option<f64> {
        self.mesh.vertices.push(position);
        match self.wanted {
            Wanted::Mesh => {}
            Wanted::Axis(axis) => self.values.push(position[axis]),
            Wanted::Property => self.values.push(wanted),
        }
        position.into_iter().find(|x| !x.is_finite())
    }

    /// Appends a face or a list of strips. `corners` is changed.
    fn push_corners(
        &mut self,
        role: Role,
        numbers: &[i64],
        corners: &mut Vec<u32>,
    ) -> Result<(), LoadErrorKind> {
        corners.clear();
        for &number in numbers {
            match u32::try_from(number) {
                Ok(v) if u64::from(v) < self.vertex_count => corners.push(v),
                _ if role == Role::Strips && number == -1 => {
                    self.push_strip(corners);
                    corners.clear();
                }
                _ => {
                    let found = quote(number.to_string().as_bytes());
                    let last = self.vertex_count as i64 - 1;
                    return Err(LoadErrorKind::VertexNumber { found, first: 0, last });
                }
            }
        }
        match role {
            Role::Strips => self.push_strip(corners),
            _ => self.mesh.push(corners),
        }
        Ok(())
    }

    /// Every second triangle of a strip is turned around. Repeated corners stitch strips together.
    fn push_strip(&mut self, strip: &[u32]) {
        for (i, w) in strip.windows(3).enumerate() {
            let [a, b, c] = [w[0], w[1], w[2]];
            if a != b && b != c && c != a {
                self.mesh.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }
}

/// Writes a mesh, binary and little-endian.
pub(super) fn write(mesh: &TriMesh, coordinates: Precision, writer: &mut impl Write) -> std::io::Result<()> {
    let (vertices, triangles) = (mesh.vertices.len() as u64, mesh.triangles.len() as u64);
    writer.write_all(&header(vertices, triangles, coordinates, &[]))?;
    write_vertices(&mesh.vertices, coordinates, writer)?;
    write_faces(mesh.triangles.iter().copied(), writer)
}

/// The header of a file that is written here, with further comments.
pub(super) fn header(vertices: u64, triangles: u64, coordinates: Precision, comments: &[String]) -> Vec<u8> {
    // `int` is what most readers expect; it cannot name the upper half of all vertices.
    let index = if vertices <= i32::MAX as u64 { "int" } else { "uint" };
    let number = match coordinates {
        Precision::F32 => "float",
        Precision::F64 => "double",
    };
    let version = env!("CARGO_PKG_VERSION");
    let mut text = format!("ply\nformat binary_little_endian 1.0\ncomment written by exocarp {version}\n");
    for comment in comments {
        text += &format!("comment {comment}\n");
    }
    text += &format!("element vertex {vertices}\n");
    for name in ["x", "y", "z"] {
        text += &format!("property {number} {name}\n");
    }
    text += &format!("element face {triangles}\nproperty list uchar {index} vertex_indices\nend_header\n");
    text.into_bytes()
}

/// Writes the vertices of a file with such a header.
pub(super) fn write_vertices(
    vertices: &[[f64; 3]],
    coordinates: Precision,
    writer: &mut impl Write,
) -> std::io::Result<()> {
    let mut bytes = Vec::with_capacity(8 * 3 * TOGETHER);
    for some in vertices.chunks(TOGETHER) {
        bytes.clear();
        let numbers = some.as_flattened().iter();
        match coordinates {
            Precision::F32 => bytes.extend(numbers.flat_map(|&x| (x as f32).to_le_bytes())),
            Precision::F64 => bytes.extend(numbers.flat_map(|&x| x.to_le_bytes())),
        }
        writer.write_all(&bytes)?;
    }
    Ok(())
}

/// Vertices or faces that are handed to the file together: one by one takes twice as long.
const TOGETHER: usize = 1024;

/// Bytes of a face.
pub(super) const FACE: usize = 13;

/// Writes the faces of a file with such a header.
pub(super) fn write_faces(
    triangles: impl IntoIterator<Item = [u32; 3]>,
    writer: &mut impl Write,
) -> std::io::Result<()> {
    let mut bytes = [3; FACE * TOGETHER];
    let mut used = 0;
    for triangle in triangles {
        let record = &mut bytes[used..used + FACE];
        for (place, v) in record[1..].chunks_exact_mut(4).zip(triangle) {
            place.copy_from_slice(&v.to_le_bytes());
        }
        used += FACE;
        if used == bytes.len() {
            writer.write_all(&bytes)?;
            used = 0;
        }
    }
    writer.write_all(&bytes[..used])?;
    Ok(())
}
