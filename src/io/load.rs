//! Loading: opening a file, and reading it by its format.

use super::error::{LoadError, LoadErrorKind, ReadError};
use super::loaded::{Content, Loaded};
use super::{Format, obj, off, ply, stl};
use crate::mesh::TriMesh;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Loads the mesh in the file `path`, unchanged but for polygons, which are triangulated, and for
/// vertices that are not finite, which are left out with the faces that have them.
/// [`load_with_notes`] also says of what was left out.
///
/// # Errors
/// When the extension is unknown, or the file is missing, empty, cut off, of another format or
/// broken, has a vertex number out of range, or no triangles with finite coordinates.
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

/// The numbers that the vertices of the PLY file `path` have under `name`, in the order of the
/// file; `None` where no such property is, or it is a list.
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
pub(super) fn open(path: &Path) -> Result<File, LoadErrorKind> {
    let kind = std::fs::metadata(path).map_err(LoadErrorKind::Open)?.file_type();
    if kind.is_dir() {
        return Err(LoadErrorKind::Open(std::io::ErrorKind::IsADirectory.into()));
    }
    if !kind.is_file() {
        return Err(LoadErrorKind::NotAFile);
    }
    File::open(path).map_err(LoadErrorKind::Open)
}

impl TriMesh {
    /// Loads a mesh file, see [`load`].
    ///
    /// # Errors
    /// See [`load`].
    pub fn load(path: impl AsRef<Path>) -> Result<TriMesh, LoadError> {
        load(path.as_ref())
    }
}

/// Reads a mesh of the given format from the beginning of `source`.
pub(super) fn read<R: Read + Seek>(mut source: R, format: Format) -> Result<Content, ReadError> {
    let length = length(&mut source)?;
    match format {
        Format::Obj => obj::read(source),
        Format::Ply => ply::read(source, length),
        Format::Stl => stl::read(source, length),
        Format::Off => off::read(source, length),
    }
}

/// The bytes of a file that has some. It is at its beginning afterwards.
pub(super) fn length(source: &mut impl Seek) -> Result<u64, ReadError> {
    let length = source.seek(SeekFrom::End(0))?;
    source.rewind()?;
    if length == 0 { Err(LoadErrorKind::Empty.into()) } else { Ok(length) }
}
