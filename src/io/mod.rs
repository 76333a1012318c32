//! Meshes in and out: OBJ, PLY, STL and OFF, chosen by the file's extension.
//!
//! | format | read | written |
//! |---|---|---|
//! | OBJ | `v` and `f`; polygons, negative numbers, `v/vt/vn` corners, continued lines | text |
//! | PLY | ascii and binary of both byte orders, further elements and properties, triangle strips | binary, little-endian |
//! | STL | binary and ascii, several solids | binary |
//! | OFF | also `COFF`, `NOFF`, `STOFF`; comments; counts on the first line; without keyword | text |
//!
//! [`load`] returns the mesh *as it stands in the file*: vertices and triangles in the file's order, nothing
//! welded, nothing dropped but what is not finite; [`clean`](crate::mesh::clean) is the next step. Text may
//! have the line ends of any system and a byte order mark. Polygons are triangulated: quads along the shorter
//! diagonal that leaves two triangles of like orientation, larger ones by cutting ears, so that concave faces
//! do not fold. Files are streamed: beside the mesh there is a fixed buffer, except for OBJ, where the parser
//! holds about 100 bytes for each vertex and face until the end of the file.
//!
//! Where a file is wrong but leaves no doubt of the mesh, it is read, and [`load_with_notes`] says what was
//! passed over: vertices with a coordinate that is not finite (left out, with the faces that have them), a
//! number of triangles in binary STL that does not fit the file's size, lines in a PLY header that begin with
//! no keyword.
//!
//! # Promises
//! - No file makes [`load`] panic, and no header makes it allocate more than the file's size justifies:
//!   the result is a mesh with finite coordinates, vertex numbers in range and at least one triangle, or
//!   a [`LoadError`] that names file, place, cause and remedy (fuzzed in `tests.rs`).
//! - [`save`] replaces an existing file whole and only when the new one is complete: the content goes to a
//!   temporary file beside it, which is renamed. A failure leaves the old file and no other.
//! - A mesh that was saved loads again with the same triangles and the same coordinates: those of the mesh
//!   rounded to f32, or as they are with [`Precision::F64`], which STL has not. So do text formats: readers
//!   of 32 and of 64 bits get the same numbers.

pub(crate) mod atomic;
mod error;
mod loaded;
mod mesh_tiles;
mod obj;
mod off;
mod ply;
mod polygon;
mod stl;
mod stream;
#[cfg(test)]
mod tests;
mod text;
pub(crate) mod tile;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

#[doc(hidden)]
pub use atomic::{directory_of, keep_permissions, resolved};
pub use error::{LoadError, LoadErrorKind, Location, SaveError, SaveErrorKind, UnknownFormat};
pub use loaded::{Loaded, Note, Passed};
pub use mesh_tiles::{merge_tiles, save_tile};
pub use stream::MeshStream;
pub use tile::{MergeError, MergeErrorKind, Tile};

use crate::mesh::TriMesh;
use crate::quantity::Precision;
use error::ReadError;
use loaded::Content;

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format (Stanford).
    Ply,
    /// Stereolithography.
    Stl,
    /// Object file format (Geomview).
    Off,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 4] = [Format::Obj, Format::Ply, Format::Stl, Format::Off];

    /// The format that belongs to the extension of `path`, in upper or lower case.
    ///
    /// # Errors
    /// When there is none; the message lists the known extensions.
    pub fn of(path: &Path) -> Result<Format, UnknownFormat> {
        let found = path.extension().unwrap_or_default().to_string_lossy();
        let format = Format::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(&found));
        format.ok_or_else(|| UnknownFormat { found: found.into_owned() })
    }

    /// The extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Off => "off",
        }
    }
}

impl std::fmt::Display for Format {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Format::Obj => "OBJ",
            Format::Ply => "PLY",
            Format::Stl => "STL",
            Format::Off => "OFF",
        })
    }
}

/// Options for writing a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SaveOptions {
    /// The number type of coordinates. STL holds 32-bit coordinates only. In text (OBJ, OFF) there
    /// are as many digits as a reader of 64 bits needs to get exactly that number.
    pub precision: Precision,
}

/// Loads the mesh in the file `path`, unchanged but for polygons, which are triangulated, and for vertices
/// that are not finite, which are left out with the faces that have them. [`load_with_notes`] also says of
/// what was left out.
///
/// # Errors
/// When the extension is unknown, or the file is missing, empty, cut off, of another format or broken, has
/// a vertex number out of range, or no triangles with finite coordinates.
pub fn load(path: &Path) -> Result<TriMesh, LoadError> {
    load_with_notes(path).map(|loaded| loaded.mesh)
}

/// Loads a mesh, with notes on what was passed over to read the file.
///
/// # Errors
/// As [`load`].
pub fn load_with_notes(path: &Path) -> Result<Loaded, LoadError> {
    let at = |format, error: ReadError| LoadError {
        path: path.to_path_buf(),
        format,
        location: error.location,
        kind: error.kind,
    };
    if path == Path::new("-") {
        return Err(at(None, LoadErrorKind::StandardInput.into()));
    }
    let format = Format::of(path).map_err(|e| at(None, LoadErrorKind::Extension(e).into()))?;
    let file = open(path).map_err(|kind| at(Some(format), kind.into()))?;
    read(file, format).and_then(|content| content.finish(path)).map_err(|error| at(Some(format), error))
}

/// The numbers that the vertices of the PLY file `path` have under `name`, in the order of the file; `None` where no
/// such property is, or it is a list.
///
/// # Errors
/// As [`load`], and when the file is of another format.
pub fn vertex_property(path: &Path, name: &str) -> Result<Option<Vec<f64>>, LoadError> {
    let at = |error: ReadError| LoadError {
        path: path.to_path_buf(),
        format: Some(Format::Ply),
        location: error.location,
        kind: error.kind,
    };
    let mut file = open(path).map_err(|kind| at(kind.into()))?;
    length(&mut file).and_then(|length| ply::vertex_property(file, length, name)).map_err(at)
}

/// Opens a file for reading; nothing else, as opening a pipe would wait for who writes to it.
fn open(path: &Path) -> Result<File, LoadErrorKind> {
    let kind = std::fs::metadata(path).map_err(LoadErrorKind::Open)?.file_type();
    if kind.is_dir() {
        return Err(LoadErrorKind::Open(std::io::ErrorKind::IsADirectory.into()));
    }
    if !kind.is_file() {
        return Err(LoadErrorKind::NotAFile);
    }
    File::open(path).map_err(LoadErrorKind::Open)
}

/// Saves `mesh` in the file `path`, in the format that belongs to the extension. An existing file is
/// replaced when the new one is complete, and left as it is when something fails.
///
/// # Errors
/// When the extension is unknown, the file cannot be written, or the format cannot hold the mesh.
pub fn save(mesh: &TriMesh, path: &Path, options: &SaveOptions) -> Result<(), SaveError> {
    let at = |kind| SaveError { path: path.to_path_buf(), kind };
    let format = Format::of(path).map_err(|e| at(SaveErrorKind::Extension(e)))?;
    check_writable(mesh, format, options).map_err(at)?;
    atomic::write_atomically(path, |writer| match format {
        Format::Obj => obj::write(mesh, options.precision, writer),
        Format::Ply => ply::write(mesh, options.precision, writer),
        Format::Stl => stl::write(mesh, writer),
        Format::Off => off::write(mesh, options.precision, writer),
    })
}

impl TriMesh {
    /// Loads a mesh file, see [`load`].
    ///
    /// # Errors
    /// See [`load`].
    pub fn load(path: impl AsRef<Path>) -> Result<TriMesh, LoadError> {
        load(path.as_ref())
    }

    /// Saves the mesh as it is, see [`save`]: with 32-bit coordinates where all of them are such
    /// numbers, and else with 64-bit ones. STL holds 32 bits only, and gets the nearest.
    ///
    /// # Errors
    /// See [`save`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SaveError> {
        let path = path.as_ref();
        let is_single = |x: &f64| f64::from(*x as f32) == *x;
        let precision = match Format::of(path) {
            Ok(Format::Stl) => Precision::F32,
            _ if self.vertices.as_flattened().iter().all(is_single) => Precision::F32,
            _ => Precision::F64,
        };
        save(self, path, &SaveOptions { precision })
    }
}

/// Reads a mesh of the given format from the beginning of `source`.
fn read<R: Read + Seek>(mut source: R, format: Format) -> Result<Content, ReadError> {
    let length = length(&mut source)?;
    match format {
        Format::Obj => obj::read(source),
        Format::Ply => ply::read(source, length),
        Format::Stl => stl::read(source, length),
        Format::Off => off::read(source, length),
    }
}

/// The bytes of a file that has some. It is at its beginning afterwards.
fn length(source: &mut impl Seek) -> Result<u64, ReadError> {
    let length = source.seek(SeekFrom::End(0))?;
    source.rewind()?;
    if length == 0 { Err(LoadErrorKind::Empty.into()) } else { Ok(length) }
}

/// Refuses, before the first byte is written, what would make a file that no one can read.
fn check_writable(mesh: &TriMesh, format: Format, options: &SaveOptions) -> Result<(), SaveErrorKind> {
    if format == Format::Stl && options.precision == Precision::F64 {
        return Err(SaveErrorKind::NoF64(format));
    }
    let single = options.precision == Precision::F32;
    let fits = |x: f64| if single { (x as f32).is_finite() } else { x.is_finite() };
    if let Some(vertex) = mesh.vertices.iter().position(|v| !v.iter().all(|&x| fits(x))) {
        return Err(SaveErrorKind::Coordinate { vertex, position: mesh.vertices[vertex] });
    }
    let in_range = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < mesh.vertices.len());
    if let Some(triangle) = mesh.triangles.iter().position(|t| !in_range(t)) {
        return Err(SaveErrorKind::VertexNumber { triangle });
    }
    // STL counts its triangles in 32 bits.
    if format == Format::Stl && u32::try_from(mesh.triangles.len()).is_err() {
        return Err(SaveErrorKind::TooManyTriangles);
    }
    Ok(())
}
