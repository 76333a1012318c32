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

mod case;
mod creases;
mod distance_error;
mod input_edges;
mod intersections;
mod missing;
mod promises;
mod report;
mod sampling;
mod settings;
mod shell;
#[cfg(test)]
pub(crate) mod tests;
mod topology;
mod welded;

pub use report::{
    Broken, CreaseReport, DistanceReport, Histogram, IntersectingPair, IntersectionReport, Judged,
    MissingReport, Promise, ShellReport, Size, Soundness, Statistics, Thickness, TopologyReport,
    VerifyReport,
};
pub use settings::{
    DEFAULT_SAMPLES, DEFAULT_SEED, MOST_SAMPLES, Subject, VerifyError, VerifySettings, Which,
};

use crate::error::Error;
use crate::geom::box_tree::BoxTree;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use case::{Case, Meshes};
use rayon::prelude::*;
use welded::Welded;

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
    on_case(input, output, settings, run, |case| {
        let topology = topology::topology(case.output);
        run.check()?;
        let intersections = intersections::intersections(case.output, &case.tree, run)?;
        let soundness = Soundness { topology, intersections };
        let distance = distance_error::distance_error(case)?;
        let missing = missing::missing(case)?;
        let creases = creases::creases(case)?;
        let shell = shell::shell(case)?;

        let mut broken = soundness.broken();
        broken.extend(settings.tolerance.iter().flat_map(|&e| promises::of_errors(&distance, &missing, e)));
        broken.extend(shell.as_ref().and_then(|s| promises::of_shell(s, settings.tolerance)));
        let judged = Judged {
            distance: case.r,
            diagonal: case.scale.diagonal,
            voxel: settings.voxel,
            tolerance: settings.tolerance,
            samples: settings.samples,
            seed: settings.seed,
        };
        Ok(VerifyReport { judged, soundness, distance, missing, creases, shell, broken })
    })
}

/// Topology and intersections of a mesh by itself.
///
/// # Errors
/// [`Error::Verify`]: a coordinate that is not finite or a vertex that does not exist. [`Error::Cancelled`].
pub fn soundness(mesh: &TriMesh, run: &RunSettings) -> Result<Soundness, Error> {
    run.install(|| {
        let welded = Welded::new(mesh, Which::Output)?;
        let topology = topology::topology(&welded);
        run.check()?;
        Ok(Soundness { topology, intersections: intersections_of(&welded, run)? })
    })
}

/// The topology of a mesh.
///
/// # Errors
/// As [`soundness`].
pub fn topology(mesh: &TriMesh, run: &RunSettings) -> Result<TopologyReport, Error> {
    run.install(|| Ok(topology::topology(&Welded::new(mesh, Which::Output)?)))
}

/// The intersecting pairs of triangles of a mesh.
///
/// # Errors
/// As [`soundness`].
pub fn intersections(mesh: &TriMesh, run: &RunSettings) -> Result<IntersectionReport, Error> {
    run.install(|| intersections_of(&Welded::new(mesh, Which::Output)?, run))
}

fn intersections_of(welded: &Welded, run: &RunSettings) -> Result<IntersectionReport, Error> {
    let tree =
        BoxTree::new(&welded.mesh.vertices, &welded.mesh.triangles, welded.with_area().into_par_iter());
    Ok(intersections::intersections(welded, &tree, run)?)
}

/// How far `output` is from the true offset surface of `input`.
///
/// # Errors
/// As [`verify`].
pub fn distance_error(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<DistanceReport, Error> {
    on_case(input, output, settings, run, |case| Ok(distance_error::distance_error(case)?))
}

/// How far the true offset surface of `input` is from `output`.
///
/// # Errors
/// As [`verify`].
pub fn missing(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<MissingReport, Error> {
    on_case(input, output, settings, run, |case| Ok(missing::missing(case)?))
}

/// How much of the creases of the true offset surface of `input` is in `output`.
///
/// # Errors
/// As [`verify`].
pub fn creases(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<CreaseReport, Error> {
    on_case(input, output, settings, run, |case| Ok(creases::creases(case)?))
}

/// Runs a part on both meshes, made ready, in the run's thread pool.
fn on_case<T: Send>(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
    part: impl FnOnce(&Case) -> Result<T, Error> + Send,
) -> Result<T, Error> {
    settings.validate()?;
    run.install(|| {
        let meshes = Meshes::new(input, output)?;
        run.check()?;
        part(&Case::new(&meshes, settings, run)?)
    })
}
