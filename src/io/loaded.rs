//! A mesh as it stands in a file, with what was passed over to read it.

use std::path::{Path, PathBuf};

use super::error::{LoadErrorKind, Location, ReadError};
use super::polygon::PolygonMesh;
use crate::mesh::TriMesh;

/// Result of [`load_with_notes`](super::load_with_notes).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The mesh.
    pub mesh: TriMesh,
    /// The vertices of the file that are not in the mesh, since a coordinate is not finite: their
    /// numbers, counted from 0, ascending. The others keep their order.
    pub left_out: Vec<u32>,
    /// Notes that a user should read.
    pub notes: Vec<Note>,
}

/// Something that is wrong with a file that was read all the same. Shown, it is one sentence with
/// file and place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The file.
    pub path: PathBuf,
    /// Location in the file; the first one, if there are several.
    pub location: Location,
    /// The part of the file that was passed over.
    pub passed: Passed,
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}: {}", self.path.display(), self.location, self.passed)
    }
}

/// A part of a file that was passed over.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Passed {
    /// Lines in a PLY header that begin with no keyword of PLY.
    HeaderLines {
        /// The first one, quoted.
        first: String,
        /// Number of lines.
        lines: usize,
    },
    /// A number of triangles in a binary STL file that does not fit its size.
    Count {
        /// The number in the file.
        said: u32,
        /// The number that fills the file.
        found: u64,
    },
    /// Vertices with a coordinate that is infinite or not a number.
    NonFinite {
        /// The first such coordinate.
        coordinate: String,
        /// Number of vertices that were left out.
        vertices: usize,
        /// Number of faces that used them, and were left out too.
        faces: usize,
    },
}

impl std::fmt::Display for Passed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let plural = |n: usize, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
        match self {
            Passed::HeaderLines { first, lines: 1 } => {
                write!(f, "{first} is no line of a PLY header and was skipped")
            }
            Passed::HeaderLines { first, lines } => {
                write!(
                    f,
                    "{first} and {} are no lines of a PLY header and were skipped",
                    plural(lines - 1, "other")
                )
            }
            Passed::Count { said, found } => write!(
                f,
                "the file says that it has {}, but has the size of {found}, which were read",
                plural(*said as usize, "triangle")
            ),
            Passed::NonFinite { coordinate, vertices, faces } => {
                let (such, them) =
                    if *vertices == 1 { ("such vertex", "it") } else { ("such vertices", "them") };
                let faces = plural(*faces, "face");
                write!(
                    f,
                    "the coordinate {coordinate} is not finite; {vertices} {such} and {faces} with {them} \
                     were left out"
                )
            }
        }
    }
}

/// The first coordinate of a file that is not finite.
#[derive(Clone, Debug)]
pub(super) struct NonFinite {
    pub(super) location: Location,
    /// As it stands there, quoted in text.
    pub(super) coordinate: String,
}

/// A file as its reader leaves it.
#[derive(Default)]
pub(super) struct Content {
    pub(super) mesh: PolygonMesh,
    /// The first coordinate that is not finite; where there is none, all vertices are finite.
    pub(super) non_finite: Option<NonFinite>,
    /// Other parts that were passed over.
    pub(super) passed: Vec<(Location, Passed)>,
}

impl Content {
    /// The mesh, without what is not finite.
    pub(super) fn finish(self, path: &Path) -> Result<Loaded, ReadError> {
        let Content { mut mesh, non_finite, mut passed } = self;
        let mut left_out = Vec::new();
        let mut nothing_left = LoadErrorKind::NoTriangles.into();
        if let Some(NonFinite { location, coordinate }) = non_finite {
            let faces = mesh.drop_non_finite(&mut left_out);
            let what = Passed::NonFinite { coordinate: coordinate.clone(), vertices: left_out.len(), faces };
            passed.push((location.clone(), what));
            nothing_left = ReadError { location, kind: LoadErrorKind::NonFinite(coordinate) };
        }
        let mesh = mesh.finish();
        if mesh.triangles.is_empty() {
            return Err(nothing_left);
        }
        let note = |(location, passed)| Note { path: path.to_path_buf(), location, passed };
        Ok(Loaded { mesh, left_out, notes: passed.into_iter().map(note).collect() })
    }
}
