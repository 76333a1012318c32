//! The recipe: from a mesh and a distance to the offset surface and its narrow band.
//!
//! ```text
//!  mesh -> hierarchy -> signed distance -> filters -> band -> edges -> contour -> mesh
//!                                                       `-> OpenVDB, where the band is kept
//! ```
//!
//! Promised for a closed, consistently oriented input: the result is closed, 2-manifold, consistently
//! oriented and free of self-intersections, on the coordinates of the chosen [`Precision`]; the same bytes
//! for every number of threads.

pub(crate) mod narrow_band;
mod resolving;
mod settings;
mod statistics;
mod stored_band;
mod surface;
#[cfg(test)]
mod tests;
mod unsuitable;

pub use crate::contour::Precision;
pub use settings::{Length, OffsetSettings, SettingsError, SignMode, Tolerance, VoxelSize};
pub use statistics::{EngineTimes, OffsetStatistics, VdbStatistics};
pub use unsuitable::{EmptyResult, InputError, MemoryError};

use crate::band::BandSettings;
use crate::contour::contour;
use crate::distance::SignedDistance;
use crate::edge::{EdgeNumbers, NearTriangles, solve};
use crate::error::Error;
use crate::mesh::{Topology, TriMesh};
use crate::run::{Phase, RunSettings};
use crate::unseen;
use crate::vdb::Band;
use narrow_band::NarrowBand;
use std::time::Instant;
use stored_band::StoredBand;
use surface::OffsetSurface;

/// What [`offset`] returns.
#[derive(Debug)]
pub struct OffsetResult {
    /// The offset surface: closed, 2-manifold, free of intersections.
    pub mesh: TriMesh,
    /// The narrow band: phi and the closest triangles, in OpenVDB grids, where it was to be kept.
    pub band: Option<Band>,
    /// What happened on the way.
    pub statistics: OffsetStatistics,
}

/// The offset surface of `mesh`: all points at the signed distance `settings.distance` from it, positive
/// outside.
///
/// # Errors
/// - [`Error::Settings`]: a distance that is not finite, a voxel size that is not positive.
/// - [`Error::Input`]: the mesh is empty, or not closed or not consistently oriented
///   ([`SignMode::Pseudonormal`] goes ahead all the same).
/// - [`Error::Empty`]: shrinking leaves nothing.
/// - [`Error::Memory`]: the band would not fit.
/// - [`Error::Contour`], [`Error::TooManyEdges`]: the lattice is too fine for the precision or the indices.
/// - [`Error::Cancelled`].
pub fn offset(mesh: &TriMesh, settings: &OffsetSettings, run: &RunSettings) -> Result<OffsetResult, Error> {
    let topology = run.install(|| Topology::new(mesh));
    unsuitable::check_input(mesh, &topology, settings.sign)?;
    let band_settings = settings.resolve(mesh)?;
    unsuitable::check_memory(mesh, &band_settings, settings.max_memory)?;

    let started = Instant::now();
    let distance = {
        let _phase = run.phase(Phase::Hierarchy, 0);
        run.install(|| SignedDistance::new(mesh, &topology))
    };
    run.check()?;
    let times = EngineTimes { hierarchy: started.elapsed().as_secs_f64(), ..EngineTimes::default() };
    resolving::until_seen(&distance, settings, band_settings, times, run)
}

/// The offset surface on one lattice. `times` is what was spent before.
fn on_lattice(
    distance: &SignedDistance,
    settings: &OffsetSettings,
    band_settings: &BandSettings,
    mut times: EngineTimes,
    run: &RunSettings,
) -> Result<OffsetResult, Error> {
    let (lattice, r) = (band_settings.lattice, band_settings.r);
    let started = Instant::now();
    let mut stored = settings.keep_band.then(|| StoredBand::new(band_settings)).transpose()?;
    let NarrowBand { signs, near, counts } =
        narrow_band::build(distance, band_settings, stored.as_mut(), run)?;
    let band = stored.map(StoredBand::finish);
    times.band += started.elapsed().as_secs_f64();

    let started = Instant::now();
    let numbers = run.install(|| EdgeNumbers::new(&signs))?;
    if numbers.is_empty() {
        return Err(EmptyResult::explain(distance, band_settings).into());
    }
    let (crossings, edges) = solve(distance, lattice, r, &signs, numbers, &near, run)?;
    let suspects = unseen::suspects(distance, r, lattice, &signs, &near, run)?;
    let NearTriangles { lists, .. } = near;
    times.edges += started.elapsed().as_secs_f64();

    let started = Instant::now();
    let contour_settings = settings.contour(lattice);
    let surface = OffsetSurface { distance, r, lists: lists.as_ref(), vanishing: 1e-4 * lattice.voxel };
    let (mesh, contour) = contour(&signs, &crossings, lattice, Some(&surface), &contour_settings, run)?;
    let unseen = unseen::confirm(suspects, &mesh, run)?;
    times.contour += started.elapsed().as_secs_f64();

    let (voxel, vdb) = (lattice.voxel, VdbStatistics::new(&counts, band.as_ref()));
    let statistics = OffsetStatistics {
        distance: r,
        voxel,
        times,
        filter: counts.filter,
        edges,
        contour,
        unseen,
        halvings: 0,
        vdb,
    };
    Ok(OffsetResult { mesh, band, statistics })
}
