//! The umbrella over the errors of all operations, for callers that let them through with `?`.
//!
//! Nothing inside the library uses it: each operation returns an error of its own.

use crate::io::{LoadError, MergeError, SaveError};
use crate::offset::OffsetError;
use crate::run::{Cancelled, ThreadError};
use crate::thicken::ThickenError;
#[cfg(feature = "openvdb")]
use crate::vdb::VdbError;
use crate::verify::VerifyError;

/// Any error of this library.
///
/// Each operation returns an error of its own, and all of them convert into this one. However a
/// run was cancelled, it is [`Error::Cancelled`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read as a mesh.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A mesh could not be written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// Tiles could not be joined.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// An offset or a band could not be made.
    #[error(transparent)]
    Offset(OffsetError),
    /// A patch could not be thickened.
    #[error(transparent)]
    Thicken(ThickenError),
    /// A mesh could not be judged.
    #[error(transparent)]
    Verify(VerifyError),
    /// A grid or a `.vdb` file could not be made, read or written.
    #[cfg(feature = "openvdb")]
    #[error(transparent)]
    Vdb(VdbError),
    /// The worker threads could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadError),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for Error {
    fn from(Cancelled: Cancelled) -> Self {
        Error::Cancelled
    }
}

impl From<OffsetError> for Error {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Cancelled => Error::Cancelled,
            other => Error::Offset(other),
        }
    }
}

impl From<VerifyError> for Error {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Cancelled => Error::Cancelled,
            other => Error::Verify(other),
        }
    }
}

impl From<ThickenError> for Error {
    fn from(error: ThickenError) -> Self {
        match error {
            ThickenError::Cancelled => Error::Cancelled,
            other => Error::Thicken(other),
        }
    }
}

#[cfg(feature = "openvdb")]
impl From<VdbError> for Error {
    fn from(error: VdbError) -> Self {
        match error {
            VdbError::Cancelled => Error::Cancelled,
            VdbError::Merge(error) => Error::Merge(error),
            other => Error::Vdb(other),
        }
    }
}
