//! The one error of the public API; each stage's own error is a variant.

use crate::io::{LoadError, SaveError};
use crate::run::{Cancelled, ThreadError};

/// Why an operation failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The worker threads could not be started.
    #[error(transparent)]
    Threads(#[from] ThreadError),
    /// A mesh file could not be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A mesh file could not be saved.
    #[error(transparent)]
    Save(#[from] SaveError),
}
