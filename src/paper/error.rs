//! Why a table could not be measured.

use crate::contour::ContourError;
use crate::io::LoadError;
use crate::lattice::LatticeError;
use crate::offset::{OffsetError, SettingsError};
use crate::run::Cancelled;
use crate::verify::VerifyError;

/// Why a table could not be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PaperError {
    /// A model's file could not be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// An offset of a model could not be made.
    #[error(transparent)]
    Offset(OffsetError),
    /// A result could not be judged.
    #[error(transparent)]
    Verify(VerifyError),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for PaperError {
    fn from(Cancelled: Cancelled) -> Self {
        PaperError::Cancelled
    }
}

impl From<OffsetError> for PaperError {
    fn from(error: OffsetError) -> Self {
        match error {
            OffsetError::Cancelled => PaperError::Cancelled,
            other => PaperError::Offset(other),
        }
    }
}

impl From<VerifyError> for PaperError {
    fn from(error: VerifyError) -> Self {
        match error {
            VerifyError::Cancelled => PaperError::Cancelled,
            other => PaperError::Verify(other),
        }
    }
}

impl From<SettingsError> for PaperError {
    fn from(error: SettingsError) -> Self {
        OffsetError::from(error).into()
    }
}

impl From<LatticeError> for PaperError {
    fn from(error: LatticeError) -> Self {
        OffsetError::from(error).into()
    }
}

impl From<ContourError> for PaperError {
    fn from(error: ContourError) -> Self {
        OffsetError::from(error).into()
    }
}
