//! The figures of a verification, all of them or one by one.

use super::case::{Case, Meshes};
use super::error::{MeshRole, VerifyError};
use super::report::{
    CreaseReport, DistanceReport, IntersectionReport, Judged, MissingReport, Soundness, TopologyReport,
    VerifyReport,
};
use super::settings::VerifySettings;
use super::welded::Welded;
use super::{promises, shell};
use crate::geom::box_tree::BoxTree;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use rayon::prelude::*;

/// Judges `output` as the offset surface of `input`.
///
/// `input` is cleaned first, as for an offset; `output` is judged as it is. A bad mesh is no error:
/// the report says what is wrong with it.
///
/// # Errors
/// - [`VerifyError::NoTriangles`], [`VerifyError::Mesh`]: nothing can be said about one of the
///   meshes.
/// - [`VerifyError::Setting`]: a setting is out of range.
/// - [`VerifyError::Cancelled`].
pub fn verify(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<VerifyReport, VerifyError> {
    on_case(input, output, settings, run, |case| {
        let topology = super::topology::topology(case.output);
        run.check()?;
        let intersections = super::intersections::intersections(case.output, &case.tree, run)?;
        let soundness = Soundness { topology, intersections };
        let distance = super::distance_error::distance_error(case)?;
        let missing = super::missing::missing(case)?;
        let creases = super::creases::creases(case)?;
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

/// Judges topology and intersections of a mesh by itself.
///
/// # Errors
/// - [`VerifyError::Mesh`]: a coordinate is not finite, or a vertex does not exist.
/// - [`VerifyError::Cancelled`].
pub fn soundness(mesh: &TriMesh, run: &RunSettings) -> Result<Soundness, VerifyError> {
    run.install(|| {
        let welded = Welded::new(mesh, MeshRole::Output)?;
        let topology = super::topology::topology(&welded);
        run.check()?;
        Ok(Soundness { topology, intersections: intersections_of(&welded, run)? })
    })
}

/// Counts the defects of a mesh's topology.
///
/// # Errors
/// As [`soundness`].
pub fn topology(mesh: &TriMesh, run: &RunSettings) -> Result<TopologyReport, VerifyError> {
    run.install(|| Ok(super::topology::topology(&Welded::new(mesh, MeshRole::Output)?)))
}

/// Finds the intersecting pairs of triangles of a mesh.
///
/// # Errors
/// As [`soundness`].
pub fn intersections(mesh: &TriMesh, run: &RunSettings) -> Result<IntersectionReport, VerifyError> {
    run.install(|| intersections_of(&Welded::new(mesh, MeshRole::Output)?, run))
}

/// Finds the intersecting pairs of a welded mesh.
fn intersections_of(welded: &Welded, run: &RunSettings) -> Result<IntersectionReport, VerifyError> {
    let tree =
        BoxTree::new(&welded.mesh.vertices, &welded.mesh.triangles, welded.with_area().into_par_iter());
    Ok(super::intersections::intersections(welded, &tree, run)?)
}

/// Measures the distance of `output` from the true offset surface of `input`.
///
/// # Errors
/// As [`verify`].
pub fn distance_error(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<DistanceReport, VerifyError> {
    on_case(input, output, settings, run, |case| Ok(super::distance_error::distance_error(case)?))
}

/// Measures the distance of the true offset surface of `input` from `output`: what is missing
/// there.
///
/// # Errors
/// As [`verify`].
pub fn missing(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<MissingReport, VerifyError> {
    on_case(input, output, settings, run, |case| Ok(super::missing::missing(case)?))
}

/// Measures the share of the creases of `input`'s true offset surface that `output` has.
///
/// # Errors
/// As [`verify`].
pub fn creases(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
) -> Result<CreaseReport, VerifyError> {
    on_case(input, output, settings, run, |case| Ok(super::creases::creases(case)?))
}

/// Prepares both meshes and runs a part of the verification, in the run's thread pool.
fn on_case<T: Send>(
    input: &TriMesh,
    output: &TriMesh,
    settings: &VerifySettings,
    run: &RunSettings,
    part: impl FnOnce(&Case) -> Result<T, VerifyError> + Send,
) -> Result<T, VerifyError> {
    settings.validate()?;
    run.install(|| {
        let meshes = Meshes::new(input, output)?;
        run.check()?;
        part(&Case::new(&meshes, settings, run)?)
    })
}
