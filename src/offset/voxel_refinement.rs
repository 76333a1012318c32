//! Finer lattices until nothing is unseen.

use super::{EmptyResult, EngineTimes, OffsetError, OffsetResult, Prepared};
use crate::band::BandSettings;
use crate::lattice::Lattice;

/// What `on_lattice` makes on the lattice that was asked for, or on one with half its voxel size, and so on, as often as
/// the settings allow and memory suffices, until nothing is unseen. Each halving takes four times as long as the round
/// before: the lattice follows the surface.
pub(super) fn until_seen(
    prepared: &Prepared<'_>,
    fits: impl Fn(&BandSettings) -> bool,
    mut on_lattice: impl FnMut(&BandSettings, EngineTimes) -> Result<OffsetResult, OffsetError>,
) -> Result<OffsetResult, OffsetError> {
    let Prepared { mut band_settings, mut times, settings, .. } = *prepared;
    for halvings in 0.. {
        let result = on_lattice(&band_settings, times);
        let finer = finer(prepared, &band_settings).filter(|f| halvings < settings.resolve && fits(f));
        match (result, finer) {
            (Ok(result), Some(finer)) if result.statistics.missed.count() > 0 => {
                times = result.statistics.times;
                band_settings = finer;
            }
            // All of it is unseen.
            (Err(OffsetError::Empty(EmptyResult::TooThin { .. })), Some(finer)) => band_settings = finer,
            (Ok(mut result), _) => {
                result.statistics.halvings = halvings;
                return Ok(result);
            }
            (Err(error), _) => return Err(error),
        }
    }
    unreachable!("the settings limit the halvings")
}

/// The lattice with half the voxel size, if its indices fit.
fn finer(prepared: &Prepared<'_>, band_settings: &BandSettings) -> Option<BandSettings> {
    let lattice = Lattice { voxel: 0.5 * band_settings.lattice.voxel };
    let finer = BandSettings { lattice, ..*band_settings };
    prepared.settings.check_range(prepared.distance.mesh(), &finer).ok()?;
    Some(finer)
}
