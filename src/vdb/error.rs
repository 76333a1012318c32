//! Why something failed with a grid or a `.vdb` file.

use crate::io::MergeError;
use crate::lattice::Ijk;
use crate::run::Cancelled;
use std::path::{Path, PathBuf};

/// Why a grid or a `.vdb` file could not be made, read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VdbError {
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// A file could not be read: it is missing, not readable, or ends too early.
    #[error("cannot read {}: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The words of the system or of OpenVDB.
        reason: String,
        /// The system's error; `None` where OpenVDB failed.
        source: Option<std::io::Error>,
    },
    /// A file could not be written: no such directory, no permission, no space.
    #[error("cannot write {}: {reason}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The words of the system or of OpenVDB.
        reason: String,
        /// The system's error; `None` where OpenVDB failed.
        source: Option<std::io::Error>,
    },
    /// A file does not begin like a `.vdb` file.
    #[error("{} is not an OpenVDB file", path.display())]
    NotVdb {
        /// The file.
        path: PathBuf,
    },
    /// A file has no grid of the wanted name or type.
    #[error("{} has no {wanted}; {}", path.display(), listed(present))]
    MissingGrid {
        /// The file.
        path: PathBuf,
        /// Name of the grid that was looked for.
        wanted: String,
        /// The grids that are there, each with its type.
        present: Vec<String>,
    },
    /// A grid is there, but cannot be used as the surface or the closest triangles.
    #[error("grid '{grid}' in {} {reason}", path.display())]
    Unsuitable {
        /// The file.
        path: PathBuf,
        /// The grid's name.
        grid: String,
        /// Fault, as the rest of a sentence.
        reason: String,
    },
    /// Voxel size or half width cannot be used.
    #[error("a band of half width {half_width} voxels of size {voxel} cannot be stored: {reason}")]
    Size {
        /// The voxel size in model units.
        voxel: f64,
        /// The half width in voxels.
        half_width: f64,
        /// Why.
        reason: &'static str,
    },
    /// Slices that belong together have different lengths.
    #[error("{count} leaves or blocks were given with {found} {what} instead of {expected}")]
    Length {
        /// The number of leaves or blocks.
        count: usize,
        /// Contents of the slice.
        what: &'static str,
        /// The length that it should have.
        expected: usize,
        /// Length of the array.
        found: usize,
    },
    /// A leaf or a block of nodes is not where one can be.
    #[error("a block of {side} nodes cannot begin at node {:?}: {reason}", origin.0)]
    Block {
        /// Lowest node of the block.
        origin: Ijk,
        /// Side of the block in nodes.
        side: u32,
        /// Why not.
        reason: &'static str,
    },
    /// Leaves were asked for that do not exist.
    #[error("leaves {first} to {end} were asked for, and the grid has {leaves}")]
    Range {
        /// The first leaf.
        first: usize,
        /// One past the last leaf.
        end: usize,
        /// The number of leaves.
        leaves: usize,
    },
    /// Tiles of a band do not belong together.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// OpenVDB failed in memory.
    #[error("OpenVDB failed: {0}")]
    OpenVdb(String),
}

impl VdbError {
    /// OpenVDB, or the content of a file, kept it from being read.
    pub(super) fn read(path: &Path, reason: impl ToString) -> Self {
        VdbError::Read { path: path.into(), reason: sentence(reason), source: None }
    }

    /// The system kept a file from being read.
    pub(super) fn read_by_system(path: &Path, error: std::io::Error) -> Self {
        VdbError::Read { path: path.into(), reason: sentence(&error), source: Some(error) }
    }

    /// OpenVDB could not write a file.
    pub(super) fn write(path: &Path, reason: impl ToString) -> Self {
        VdbError::Write { path: path.into(), reason: sentence(reason), source: None }
    }

    /// The system kept a file from being written.
    pub(super) fn write_by_system(path: &Path, error: std::io::Error) -> Self {
        VdbError::Write { path: path.into(), reason: sentence(&error), source: Some(error) }
    }
}

impl From<Cancelled> for VdbError {
    fn from(Cancelled: Cancelled) -> Self {
        VdbError::Cancelled
    }
}

impl From<cxx::Exception> for VdbError {
    fn from(exception: cxx::Exception) -> Self {
        VdbError::OpenVdb(sentence(exception))
    }
}

/// Returns the text of an exception or a system error, in one line and without what only
/// programmers know.
fn sentence(reason: impl ToString) -> String {
    let text = reason.to_string();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    // OpenVDB's exceptions begin with the name of their class, the system's errors end with a
    // number.
    let text = match text.split_once(": ") {
        Some((class, rest)) if class.ends_with("Error") && !class.contains(' ') => rest.to_owned(),
        _ => text,
    };
    match text.split_once(" (os error") {
        Some((sentence, _)) => sentence.to_owned(),
        None => text,
    }
}

fn listed(present: &[String]) -> String {
    match present {
        [] => "it holds no grids".into(),
        names => format!("it holds {}", names.join(", ")),
    }
}
