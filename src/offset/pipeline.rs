//! The operations: prepare the input, run the stages.

use super::prepared::Prepared;
use super::stages::run_stages;
use super::stored_band::{Band, StoredBand};
use super::voxel_refinement::refine_until_resolved;
#[cfg(feature = "openvdb")]
use super::{BandOptions, BandResult};
use super::{EmptyResult, EngineTimes, OffsetError, OffsetResult, OffsetSettings};
use super::{OffsetStatistics, memory};
use crate::band::BandSettings;
#[cfg(feature = "openvdb")]
use crate::band::narrow_band;
use crate::band::narrow_band::StoredPart;
use crate::contour::SlabContour;
use crate::distance::SignedDistance;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use crate::subvoxel::MissedFeatures;
#[cfg(feature = "openvdb")]
use std::time::Instant;

/// Makes the offset surface of `mesh`: all points at the signed distance `settings.distance` from
/// it, positive outside.
///
/// # Errors
/// - [`OffsetError::Settings`]: a distance that is not finite, a voxel size that is not positive.
/// - [`OffsetError::Input`]: the mesh is empty, has a vertex number out of range or a coordinate
///   that is not finite, or is not closed or not consistently oriented
///   ([`OpenInput::Accept`](super::OpenInput) goes ahead all the same).
/// - [`OffsetError::Empty`]: shrinking leaves nothing.
/// - [`OffsetError::Memory`]: the band would not fit.
/// - [`OffsetError::Lattice`]: the lattice is too fine for the precision or the indices.
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
        let ((mesh, band), statistics) = refine_until_resolved(prepared, fits, |band_settings, times| {
            on_lattice(prepared.distance, settings, band_settings, times, run)
        })?;
        #[cfg(not(feature = "openvdb"))]
        let _ = band;
        Ok(OffsetResult {
            mesh,
            precision: settings.precision,
            #[cfg(feature = "openvdb")]
            band,
            statistics,
        })
    })
}

/// Makes the narrow band of an offset in OpenVDB grids, and no mesh: no edge is intersected.
///
/// Settings without a [`band`](OffsetSettings::band) make the usual one.
///
/// # Errors
/// As [`offset()`].
#[cfg(feature = "openvdb")]
pub fn offset_band(
    mesh: &TriMesh,
    settings: &OffsetSettings,
    run: &RunSettings,
) -> Result<BandResult, OffsetError> {
    let options: BandOptions = settings.band.unwrap_or_default();
    let settings = &OffsetSettings { band: Some(options), ..settings.clone() };
    Prepared::with(mesh, settings, run, |prepared| {
        let Prepared { distance, ref band_settings, times, .. } = *prepared;
        memory::check_memory(distance, band_settings, StoredPart::by(settings), settings.max_memory, run)?;
        let mut statistics = OffsetStatistics::new(band_settings, times);
        let started = Instant::now();
        let mut stored = StoredBand::new(band_settings, &options)?;
        statistics.add_band(&narrow_band::store::<OffsetError>(distance, band_settings, &mut stored, run)?);
        let band = stored.finish();
        statistics.times.band += started.elapsed().as_secs_f64();
        if statistics.vdb.leaves == 0 {
            return Err(EmptyResult::explain(distance, band_settings, run)?.into());
        }
        statistics.set_memory(Some(&band));
        Ok(BandResult { band, statistics })
    })
}

/// The mesh of an offset surface, and its band where it is kept.
type MeshAndBand = (TriMesh, Option<Band>);

/// Makes the offset surface on one lattice. `times` is the time spent before.
fn on_lattice(
    distance: &SignedDistance,
    settings: &OffsetSettings,
    band_settings: &BandSettings,
    times: EngineTimes,
    run: &RunSettings,
) -> Result<(MeshAndBand, OffsetStatistics), OffsetError> {
    let mut statistics = OffsetStatistics::new(band_settings, times);
    let mut stored = StoredBand::wanted(band_settings, settings)?;
    let done = run_stages(distance, settings, band_settings, stored.as_mut(), &mut statistics, run)?;
    let Some((SlabContour { mesh, .. }, lost)) = done else {
        return Err(EmptyResult::explain(distance, band_settings, run)?.into());
    };
    statistics.missed = MissedFeatures::new(lost);
    statistics.slabs = 1;
    let band = stored.map(StoredBand::finish);
    statistics.set_memory(band.as_ref());
    Ok(((mesh, band), statistics))
}
