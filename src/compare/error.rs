//! Why a comparison could not be made.

use super::Method;
use crate::io::{LoadError, SaveError};
use crate::offset::{InputError, OffsetError, SettingsError};
use crate::run::Cancelled;
use crate::vdb::VdbError;
use crate::verify::VerifyError;
use std::path::PathBuf;

/// Why there is no comparison.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A program could not be started.
    #[error("{} cannot be started: {source}", program.display())]
    Start {
        /// The program.
        program: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// No directory for the intermediate files.
    #[error("there is no room for temporary files: {0}")]
    Temporary(#[source] std::io::Error),
    /// The method runs in Python, not in this program.
    #[error("{} runs in Python, not in this program", .0.title())]
    NotHere(Method),
    /// A picture could not be encoded.
    #[error("a picture could not be encoded: {0}")]
    Picture(String),
    /// A setting makes no sense.
    #[error("{0}")]
    Setting(&'static str),
    /// An intermediate file could not be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// An intermediate file could not be written.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// An offset could not be made.
    #[error(transparent)]
    Offset(OffsetError),
    /// A result could not be judged.
    #[error(transparent)]
    Verify(VerifyError),
    /// OpenVDB failed.
    #[error(transparent)]
    Vdb(VdbError),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for CompareError {
    fn from(Cancelled: Cancelled) -> Self {
        CompareError::Cancelled
    }
}

impl From<OffsetError> for CompareError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Cancelled => CompareError::Cancelled,
            other => CompareError::Offset(other),
        }
    }
}

impl From<VerifyError> for CompareError {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Cancelled => CompareError::Cancelled,
            other => CompareError::Verify(other),
        }
    }
}

impl From<VdbError> for CompareError {
    fn from(error: VdbError) -> Self {
        match error {
            VdbError::Cancelled => CompareError::Cancelled,
            other => CompareError::Vdb(other),
        }
    }
}

impl From<InputError> for CompareError {
    fn from(error: InputError) -> Self {
        CompareError::Offset(error.into())
    }
}

impl From<SettingsError> for CompareError {
    fn from(error: SettingsError) -> Self {
        CompareError::Offset(error.into())
    }
}
