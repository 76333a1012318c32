//! Why a verification cannot be done.

use crate::mesh::MeshError;
use crate::run::Cancelled;
use std::fmt;

/// Why a verification cannot be done. A bad mesh is no error: the report says what is wrong with
/// it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// A mesh has no triangles with three different corners.
    #[error("{0} has no triangles")]
    NoTriangles(MeshRole),
    /// A vertex or a triangle cannot be worked with.
    #[error("{which}: {source}")]
    Mesh {
        /// The mesh.
        which: MeshRole,
        /// The fault of the mesh.
        source: MeshError,
    },
    /// A setting is out of range.
    #[error("the {name} must be {range}, not {value}")]
    Setting {
        /// Name of the setting, for messages.
        name: &'static str,
        /// Range of the setting, in words.
        range: &'static str,
        /// Value of the setting.
        value: f64,
    },
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for VerifyError {
    fn from(Cancelled: Cancelled) -> Self {
        VerifyError::Cancelled
    }
}

/// One of the two meshes of a verification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshRole {
    /// The mesh that was offset.
    Input,
    /// The mesh that is judged.
    Output,
}

impl fmt::Display for MeshRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MeshRole::Input => "INPUT",
            MeshRole::Output => "OUTPUT",
        })
    }
}
