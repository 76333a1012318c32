//! Whether a mesh is the offset surface that it is said to be.
//!
//! ```text
//!  OUTPUT -> weld -> topology
//!                 -> box tree -> intersections
//!  INPUT, OUTPUT  -> distance    how far OUTPUT is from the true offset surface
//!                 -> missing     how far the true offset surface is from OUTPUT
//!                 -> creases     what OUTPUT has of the true offset surface's creases
//!                 -> shell       the wall between two sheets
//!  all            -> report      and the promises that are broken
//! ```
//!
//! OUTPUT may come from any program. Topology and intersections are exact on the coordinates as they are
//! given. The other figures are taken at samples, which depend on the seed alone: a report is the same for
//! every number of threads.

mod report;
mod settings;

pub use report::{
    Broken, CreaseReport, DistanceReport, Histogram, IntersectingPair, IntersectionReport, Judged,
    MissingReport, Promise, ShellReport, Size, Soundness, Statistics, Thickness, TopologyReport,
    VerifyReport,
};
pub use settings::{DEFAULT_SAMPLES, DEFAULT_SEED, Subject, VerifyError, VerifySettings, Which};

use crate::error::Error;
use crate::mesh::TriMesh;
use crate::run::RunSettings;

/// Judges `output` as the offset surface of `input`. `input` is cleaned first, as for an offset; `output` is
/// judged as it is.
///
/// # Errors
/// [`Error::Verify`]: a mesh or a setting that nothing can be said about. [`Error::Cancelled`]. A bad mesh is
/// no error: the report says what is wrong.
pub fn verify(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<VerifyReport, Error> {
    let _ = (input, output, settings, run);
    unimplemented!()
}

/// Topology and intersections of a mesh by itself.
///
/// # Errors
/// [`Error::Verify`]: a coordinate that is not finite or a vertex that does not exist. [`Error::Cancelled`].
pub fn soundness(mesh: &TriMesh, run: &RunSettings) -> Result<Soundness, Error> {
    let _ = (mesh, run);
    unimplemented!()
}

/// The topology of a mesh.
///
/// # Errors
/// As [`soundness`].
pub fn topology(mesh: &TriMesh, run: &RunSettings) -> Result<TopologyReport, Error> {
    let _ = (mesh, run);
    unimplemented!()
}

/// The intersecting pairs of triangles of a mesh.
///
/// # Errors
/// As [`soundness`].
pub fn intersections(mesh: &TriMesh, run: &RunSettings) -> Result<IntersectionReport, Error> {
    let _ = (mesh, run);
    unimplemented!()
}
