//! Errors of mesh files: each is one sentence with file, place, cause and remedy.

use std::path::PathBuf;

use super::Format;

/// Why a mesh file could not be loaded.
#[derive(Debug, thiserror::Error)]
#[error("{}{location}: {kind}", .path.display())]
pub struct LoadError {
    /// The file.
    pub path: PathBuf,
    /// Format of the file; `None` when the extension is not known.
    pub format: Option<Format>,
    /// The position of the cause in the file.
    pub location: Location,
    /// The cause.
    #[source]
    pub kind: LoadErrorKind,
}

/// The extension of a file belongs to no known format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the extension {found:?} is not known; use .obj, .ply, .stl or .off")]
pub struct UnknownFormat {
    /// The extension, without the dot; empty when there is none.
    pub found: String,
}

/// A position in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Location {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(u64),
    /// A byte of a binary file, counted from 0.
    Byte(u64),
    /// An element of a binary file.
    Element {
        /// "vertex", "face", "triangle" or the name in the PLY header.
        name: String,
        /// Number of the element among those of its kind, counted from 0.
        number: u64,
        /// The byte at which reading it stopped, counted from 0.
        byte: u64,
    },
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Location::File => Ok(()),
            Location::Line(line) => write!(f, ", line {line}"),
            Location::Byte(byte) => write!(f, ", byte {byte}"),
            Location::Element { name, number, byte } => write!(f, ", {name} {number} (byte {byte})"),
        }
    }
}

/// The cause of a [`LoadError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadErrorKind {
    /// The file cannot be opened.
    #[error("the file cannot be opened ({0}); check the path and the permissions")]
    Open(#[source] std::io::Error),
    /// The path names something else than a file: a pipe, a device.
    #[error("this is a pipe or a device; save what comes from it as a file and name that")]
    NotAFile,
    /// The path is the usual name of standard input.
    #[error("standard input is not read; save the model as a file and name that")]
    StandardInput,
    /// Reading failed.
    #[error("reading failed ({0}); check the disk or copy the file again")]
    Read(#[source] std::io::Error),
    /// The extension belongs to no known format.
    #[error(transparent)]
    Extension(#[from] UnknownFormat),
    /// The file has no content.
    #[error("the file is empty; export the model again")]
    Empty,
    /// The content is of another format than the extension says.
    #[error("this is not {format} ({reason}); check that the extension fits the content")]
    WrongFormat {
        /// The format that the extension stands for.
        format: Format,
        /// Evidence for the wrong format.
        reason: String,
    },
    /// The file ends too early.
    #[error("the file ends before {missing}; it was cut off, get a complete copy")]
    Truncated {
        /// Text that should have followed.
        missing: String,
    },
    /// Something else stands where a certain thing belongs.
    #[error("{found} stands where {expected} belongs; correct it or export the model again")]
    Syntax {
        /// Text that stands in the file.
        found: String,
        /// Description of the text that belongs there.
        expected: String,
    },
    /// A coordinate is infinite or not a number.
    #[error("the coordinate {0} is not finite; repair the model in the program that made it")]
    NonFinite(String),
    /// A face names a vertex that is not there.
    #[error("a face names vertex {found}, but the vertices are {first} to {last}; repair the model")]
    VertexNumber {
        /// The number in the file.
        found: String,
        /// The first vertex number of the format.
        first: u64,
        /// The last vertex number of the file (`first - 1` without vertices).
        last: i64,
    },
    /// The file is in order but has no triangles.
    #[error("the file has no triangles; export a surface mesh, not points or curves")]
    NoTriangles,
    /// A variant of the format that is not read.
    #[error("{what} is not supported; {remedy}")]
    Unsupported {
        /// The variant.
        what: String,
        /// Remedy, as the rest of a sentence.
        remedy: &'static str,
    },
    /// More vertices than 32-bit numbers can name.
    #[error("the file has more than {} vertices; split the model", u32::MAX)]
    TooManyVertices,
}

/// A [`LoadErrorKind`] at its [`Location`]: a [`LoadError`] before the path is known.
#[derive(Debug)]
pub(super) struct ReadError {
    pub(super) location: Location,
    pub(super) kind: LoadErrorKind,
}

impl From<LoadErrorKind> for ReadError {
    fn from(kind: LoadErrorKind) -> Self {
        ReadError { location: Location::File, kind }
    }
}

impl From<std::io::Error> for ReadError {
    fn from(error: std::io::Error) -> Self {
        LoadErrorKind::Read(error).into()
    }
}

impl LoadErrorKind {
    /// Puts the error on line `line`, counted from 1.
    pub(super) fn on_line(self, line: u64) -> ReadError {
        ReadError { location: Location::Line(line), kind: self }
    }

    /// A [`LoadErrorKind::Syntax`] that quotes `found`.
    pub(super) fn syntax(found: &[u8], expected: impl Into<String>) -> LoadErrorKind {
        LoadErrorKind::Syntax { found: quote(found), expected: expected.into() }
    }

    /// A [`LoadErrorKind::Truncated`].
    pub(super) fn truncated(missing: impl Into<String>) -> LoadErrorKind {
        LoadErrorKind::Truncated { missing: missing.into() }
    }
}

/// A piece of the file, in quotes, printable, and short enough for a sentence.
pub(super) fn quote(bytes: &[u8]) -> String {
    /// Longer pieces would bury the sentence; shorter ones would cut ordinary lines of three
    /// numbers.
    const LONGEST: usize = 60;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)]);
    let text = text.trim();
    let mut quoted: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().count() > LONGEST {
        quoted.push_str("...");
    }
    format!("\"{quoted}\"")
}

/// Why a file could not be saved.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", .path.display())]
pub struct SaveError {
    /// The file that was to be written.
    pub path: PathBuf,
    /// The cause.
    #[source]
    pub kind: SaveErrorKind,
}

/// The cause of a [`SaveError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveErrorKind {
    /// The extension belongs to no known format.
    #[error(transparent)]
    Extension(#[from] UnknownFormat),
    /// No file can be created in the directory.
    #[error("no file can be created there ({0}); check that the directory exists and is writable")]
    Create(#[source] std::io::Error),
    /// Writing failed.
    #[error("writing failed ({0}); check the free space, the output was left as it was")]
    Write(#[source] std::io::Error),
    /// The complete file could not take its place.
    #[error("the complete file could not be put in place ({0}); check the permissions of the target")]
    Replace(#[source] std::io::Error),
    /// A coordinate is not finite, or too large for single precision.
    #[error(
        "vertex {vertex} at {position:?} does not fit the number type of the file; write f64 if the model is that large"
    )]
    Coordinate {
        /// The vertex.
        vertex: usize,
        /// Position of the vertex.
        position: [f64; 3],
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names a vertex that the mesh does not have; build the mesh anew")]
    VertexNumber {
        /// The triangle.
        triangle: usize,
    },
    /// A format without 64-bit coordinates.
    #[error("{0} has no 64-bit coordinates; write .ply, .obj or .off, or choose 32-bit coordinates")]
    NoF64(Format),
    /// A format that cannot be written piece by piece.
    #[error("{0} cannot be written piece by piece; write .ply or .stl")]
    NotInPieces(Format),
    /// More triangles than STL can count.
    #[error("the mesh has more than {} triangles, the limit of STL; write .ply instead", u32::MAX)]
    TooManyTriangles,
}
