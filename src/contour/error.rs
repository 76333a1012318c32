//! Failures of the contour.

use crate::lattice::LatticeError;
use crate::run::Cancelled;

/// Why contouring failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContourError {
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The lattice is too fine.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
}
