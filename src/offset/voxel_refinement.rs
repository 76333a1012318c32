//! Finer lattices until nothing is unseen.

use super::prepared::Prepared;
use super::{EmptyResult, EngineTimes, OffsetError, OffsetStatistics};
use crate::band::BandSettings;
use crate::lattice::Lattice;

/// Returns the result of `on_lattice` on the lattice that was asked for, or on one with half its
/// voxel size, and so on, as often as the settings allow and memory suffices, until nothing is
/// unseen. Each halving takes four times as long as the round before: the lattice follows the
/// surface.
pub(super) fn refine_until_resolved<T>(
    prepared: &Prepared<'_>,
    fits: impl Fn(&BandSettings) -> bool,
    mut on_lattice: impl FnMut(&BandSettings, EngineTimes) -> Result<(T, OffsetStatistics), OffsetError>,
) -> Result<(T, OffsetStatistics), OffsetError> {
    let Prepared { mut band_settings, mut times, settings, .. } = *prepared;
    for halvings in 0.. {
        let result = on_lattice(&band_settings, times);
        let finer = finer(prepared, &band_settings).filter(|f| halvings < settings.max_halvings && fits(f));
        match (result, finer) {
            (Ok((_, statistics)), Some(finer)) if statistics.missed.count() > 0 => {
                times = statistics.times;
                band_settings = finer;
            }
            // All of it is unseen.
            (Err(OffsetError::Empty(EmptyResult::TooThin { .. })), Some(finer)) => band_settings = finer,
            (Ok((result, mut statistics)), _) => {
                statistics.halvings = halvings;
                return Ok((result, statistics));
            }
            (Err(error), _) => return Err(error),
        }
    }
    unreachable!("the settings limit the halvings")
}

/// Returns the lattice with half the voxel size, if its indices fit.
fn finer(prepared: &Prepared<'_>, band_settings: &BandSettings) -> Option<BandSettings> {
    let lattice = Lattice { voxel: 0.5 * band_settings.lattice.voxel };
    let finer = BandSettings { lattice, ..*band_settings };
    prepared.settings.check_range(prepared.distance.mesh(), &finer).ok()?;
    Some(finer)
}
