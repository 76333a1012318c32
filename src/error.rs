//! The one error of the public API; each stage's own error is a variant.

use crate::compare::CompareError;
use crate::contour::ContourError;
use crate::edge::TooManyEdges;
use crate::io::{LoadError, MergeError, SaveError};
use crate::offset::{EmptyResult, InputError, MemoryError, SettingsError};
use crate::run::{Cancelled, ThreadError};
use crate::thicken::ThickenError;
use crate::vdb::VdbError;
use crate::verify::VerifyError;

/// Why an operation failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read as a mesh.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A file could not be written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// Tiles cannot be joined.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// The mesh is not suitable.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The settings make no sense.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The work would not fit into memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The surface crosses too many grid edges.
    #[error(transparent)]
    TooManyEdges(#[from] TooManyEdges),
    /// The result is empty.
    #[error(transparent)]
    Empty(#[from] EmptyResult),
    /// Contouring failed.
    #[error(transparent)]
    Contour(#[from] ContourError),
    /// OpenVDB failed.
    #[error(transparent)]
    Vdb(#[from] VdbError),
    /// A verification cannot be done.
    #[error(transparent)]
    Verify(VerifyError),
    /// A patch cannot be thickened.
    #[error(transparent)]
    Thicken(#[from] ThickenError),
    /// A comparison could not be made.
    #[error(transparent)]
    Compare(CompareError),
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The worker threads could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadError),
}

impl From<CompareError> for Error {
    fn from(error: CompareError) -> Self {
        match error {
            CompareError::Cancelled => Error::Cancelled(Cancelled),
            other => Error::Compare(other),
        }
    }
}

impl From<VerifyError> for Error {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Cancelled => Error::Cancelled(Cancelled),
            other => Error::Verify(other),
        }
    }
}
