//! The whole of a thickening: checks, then attempts on ever finer lattices.

use super::attempt::{Attempts, SurfaceFacts};
use super::outcome::{Blockage, Outcome};
use super::patch::boundary::Boundary;
use super::patch::holes::{CappedPatch, Holes};
use super::patch::intersections;
use super::settings::ModelUnits;
use super::{
    PatchError, PatchSide, ShapeCounts, ThickenError, ThickenSettings, ThickenStatistics, ThickenTimes,
    TriangleCounts,
};
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;
use std::time::Instant;

/// The solid that [`thicken`] makes, with statistics.
#[derive(Debug)]
pub struct ThickenResult {
    /// The boundary of the solid. Its first triangles are those of the patch, in the patch's order.
    pub mesh: TriMesh,
    /// Counts and times of the run.
    pub statistics: ThickenStatistics,
}

/// Makes the solid of the given thickness on one side of `patch` (\[WC13\] Definition 2).
///
/// # Errors
/// - [`ThickenError::Settings`]: a setting makes no sense.
/// - [`ThickenError::Patch`]: the patch is empty, not oriented, not 2-manifold or intersects
///   itself.
/// - [`ThickenError::Obstacle`]: no lattice was fine enough for a place of the patch.
/// - [`ThickenError::Memory`]: the lattice would not fit.
/// - [`ThickenError::Lattice`]: the lattice is too fine for the indices or the precision.
/// - [`ThickenError::Offset`]: the offset of a closed patch cannot be made.
/// - [`ThickenError::Cancelled`].
pub fn thicken(
    patch: &TriMesh,
    settings: &ThickenSettings,
    run: &RunSettings,
) -> Result<ThickenResult, ThickenError> {
    settings.validate()?;
    if patch.triangles.is_empty() {
        return Err(PatchError::NoTriangles.into());
    }
    patch.check().map_err(PatchError::from)?;
    let wanted = settings.in_model_units(patch)?;
    let started = Instant::now();
    let patch = as_written(patch, settings);
    let topology = run.install(|| Topology::new(&patch));
    let (boundary, checked) = run.install(|| {
        rayon::join(|| Boundary::new(&patch, &topology), || intersections::check_patch(&patch, run))
    });
    let boundary = boundary?;
    checked?;
    let holes = Holes::new(&patch, &topology, &boundary);
    let mut attempts =
        Attempts { settings, run, times: ThickenTimes::default(), shape: ShapeCounts::default() };
    attempts.times.hierarchy = started.elapsed().as_secs_f64();
    attempts.check_memory(&patch, &boundary, wanted)?;
    let (mut halvings, mut at) = (0, wanted);
    let mut capped_holes = holes.too_narrow(at.voxel);
    let (mesh, capped) = loop {
        let CappedPatch { mesh: surface, capped } = run.install(|| holes.cap(&capped_holes, run))?;
        let facts = SurfaceFacts { topology: &topology, boundary: &boundary };
        // Without caps the surface is the patch.
        let facts = capped.is_empty().then_some(facts);
        let Blockage { obstacle, at: place, edges } = match attempts.attempt(&surface, facts, at)? {
            Outcome::Done(mesh) => break (mesh, capped),
            Outcome::Blocked(blockage) => blockage,
        };
        let before = capped_holes.len();
        capped_holes.extend(holes.at_edges(&edges, at.voxel));
        if capped_holes.len() > before {
            continue;
        }
        let finer = ModelUnits { voxel: 0.5 * at.voxel, ..at };
        if halvings == settings.max_halvings || attempts.check_memory(&patch, &boundary, finer).is_err() {
            return Err(ThickenError::Obstacle { obstacle, at: place, voxel: at.voxel });
        }
        halvings += 1;
        at = finer;
        capped_holes = holes.too_narrow(at.voxel);
    };
    let kept = patch.triangles.len() as u64;
    let triangles = TriangleCounts { kept, split: 0, new: mesh.triangles.len() as u64 - kept };
    let ModelUnits { thickness, voxel } = at;
    let Attempts { times, shape, .. } = attempts;
    let statistics = ThickenStatistics { thickness, voxel, halvings, times, triangles, capped, shape };
    Ok(ThickenResult { mesh, statistics })
}

/// Returns the patch on the coordinates that will be written, with the solid on its negative side.
fn as_written(patch: &TriMesh, settings: &ThickenSettings) -> TriMesh {
    let vertices = patch.vertices.iter().map(|v| v.map(|x| settings.precision.round(x))).collect();
    let triangles = match settings.side {
        PatchSide::Inner => patch.triangles.clone(),
        PatchSide::Outer => patch.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    };
    TriMesh { vertices, triangles }
}
