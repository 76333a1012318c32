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

mod stream;
mod memory;
mod job;
mod stages;
mod voxel_refinement;
mod partition;
mod settings;
mod statistics;
mod stored_band;
mod surface;
#[cfg(test)]
mod tests;
mod error;

pub use crate::contour::Precision;
pub use error::{EmptyResult, InputError, OffsetError};
pub use job::job;
pub use memory::{MemoryError, available_memory};
pub use settings::{Length, OffsetSettings, SettingsError, SignMode, Tolerance, VoxelSize};
pub use statistics::{EngineTimes, OffsetStatistics, VdbStatistics};
pub use stream::{Cut, PieceSink, SinkError, offset_in_slabs};

use crate::band::BandSettings;
use crate::band::narrow_band::{self, StoredPart};
use crate::contour::SlabContour;
use crate::distance::SignedDistance;
use crate::mesh::{Topology, TriMesh};
use crate::run::{Phase, RunSettings};
use crate::subvoxel::MissedFeatures;
use crate::vdb::Band;
use stages::on_slab;
use std::time::Instant;
use stored_band::StoredBand;
use voxel_refinement::until_seen;

/// What [`offset`] returns.
#[derive(Debug)]
pub struct OffsetResult {
    /// The offset surface: closed, 2-manifold, free of intersections.
    pub mesh: TriMesh,
    /// The narrow band, in OpenVDB grids, where it was to be kept: phi, and the closest triangles where they
    /// were, too.
    pub band: Option<Band>,
    /// What happened on the way.
    pub statistics: OffsetStatistics,
}

/// The offset surface of `mesh`: all points at the signed distance `settings.distance` from it, positive
/// outside.
///
/// # Errors
/// - [`OffsetError::Settings`]: a distance that is not finite, a voxel size that is not positive.
/// - [`OffsetError::Input`]: the mesh is empty, or not closed or not consistently oriented
///   ([`SignMode::Pseudonormal`] goes ahead all the same).
/// - [`OffsetError::Empty`]: shrinking leaves nothing.
/// - [`OffsetError::Memory`]: the band would not fit.
/// - [`OffsetError::CoarseCoordinates`], [`OffsetError::TooManyEdges`],
///   [`OffsetError::TooManyVertices`]: the lattice is too fine for the precision or the indices.
/// - [`OffsetError::Vdb`]: OpenVDB cannot hold the band that was to be kept.
/// - [`OffsetError::Cancelled`].
pub fn offset(
    mesh: &TriMesh,
    settings: &OffsetSettings,
    run: &RunSettings,
) -> Result<OffsetResult, OffsetError> {
    Prepared::with(mesh, settings, run, |prepared| {
        let stored = StoredPart::by(settings);
        let fits = |band_settings: &BandSettings| {
            memory::check_memory(prepared.distance, band_settings, stored, settings.max_memory, run).is_ok()
        };
        memory::check_memory(prepared.distance, &prepared.band_settings, stored, settings.max_memory, run)?;
        memory::check_countable(mesh, &prepared.band_settings)?;
        until_seen(prepared, fits, |band_settings, times| {
            on_lattice(prepared.distance, settings, band_settings, times, run)
        })
    })
}

/// The narrow band of an offset, in OpenVDB grids, and no mesh: no edge is intersected.
///
/// # Errors
/// As [`offset()`].
pub fn offset_band(
    mesh: &TriMesh,
    settings: &OffsetSettings,
    run: &RunSettings,
) -> Result<OffsetResult, OffsetError> {
    Prepared::with(mesh, settings, run, |prepared| {
        let Prepared { distance, ref band_settings, times, .. } = *prepared;
        let stored = StoredPart::by(&OffsetSettings { keep_band: true, ..settings.clone() });
        memory::check_memory(distance, band_settings, stored, settings.max_memory, run)?;
        let mut statistics = OffsetStatistics::new(band_settings, times);
        let started = Instant::now();
        let mut stored = StoredBand::new(band_settings, settings)?;
        statistics.add_band(&narrow_band::store::<OffsetError>(distance, band_settings, &mut stored, run)?);
        let band = stored.finish();
        statistics.times.band += started.elapsed().as_secs_f64();
        if statistics.vdb.leaves == 0 {
            return Err(EmptyResult::explain(distance, band_settings, run)?.into());
        }
        statistics.set_memory(Some(&band));
        Ok(OffsetResult { mesh: TriMesh::default(), band: Some(band), statistics })
    })
}

/// The input, ready for work on a lattice.
#[derive(Clone, Copy)]
pub(crate) struct Prepared<'a> {
    distance: &'a SignedDistance<'a>,
    settings: &'a OffsetSettings,
    /// The lattice that was asked for.
    band_settings: BandSettings,
    /// What was spent so far.
    times: EngineTimes,
    run: &'a RunSettings,
}

impl Prepared<'_> {
    /// Checks the input, builds its hierarchy, and hands both to `work`.
    fn with<T>(
        mesh: &TriMesh,
        settings: &OffsetSettings,
        run: &RunSettings,
        work: impl FnOnce(&Prepared<'_>) -> Result<T, OffsetError>,
    ) -> Result<T, OffsetError> {
        error::check_mesh(mesh)?;
        let topology = run.install(|| Topology::new(mesh));
        error::check_input(mesh, &topology, settings.sign)?;
        let band_settings = settings.resolve(mesh)?;
        let started = Instant::now();
        let distance = {
            let _phase = run.phase(Phase::Hierarchy, 0);
            run.install(|| SignedDistance::new(mesh, &topology))
        };
        run.check()?;
        let times = EngineTimes { hierarchy: started.elapsed().as_secs_f64(), ..EngineTimes::default() };
        work(&Prepared { distance: &distance, settings, band_settings, times, run })
    }
}

/// The offset surface on one lattice. `times` is what was spent before.
fn on_lattice(
    distance: &SignedDistance,
    settings: &OffsetSettings,
    band_settings: &BandSettings,
    times: EngineTimes,
    run: &RunSettings,
) -> Result<OffsetResult, OffsetError> {
    let mut statistics = OffsetStatistics::new(band_settings, times);
    let mut stored = settings.keep_band.then(|| StoredBand::new(band_settings, settings)).transpose()?;
    let done = on_slab(distance, settings, band_settings, stored.as_mut(), &mut statistics, run)?;
    let Some((SlabContour { mesh, .. }, lost)) = done else {
        return Err(EmptyResult::explain(distance, band_settings, run)?.into());
    };
    statistics.missed = MissedFeatures::new(lost);
    statistics.slabs = 1;
    let band = stored.map(StoredBand::finish);
    statistics.set_memory(band.as_ref());
    Ok(OffsetResult { mesh, band, statistics })
}
