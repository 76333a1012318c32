//! Finer lattices until nothing is unseen.

use super::{EmptyResult, EngineTimes, OffsetResult, OffsetSettings, on_lattice, unsuitable};
use crate::band::BandSettings;
use crate::distance::SignedDistance;
use crate::error::Error;
use crate::lattice::Lattice;
use crate::run::RunSettings;

/// The offset surface on the lattice of `band_settings`, or on one with half its voxel size, and so on, as often as the
/// settings allow and memory suffices, until nothing is unseen. Each halving takes four times as long as the round
/// before: the lattice follows the surface.
pub(super) fn until_seen(
    distance: &SignedDistance,
    settings: &OffsetSettings,
    mut band_settings: BandSettings,
    mut times: EngineTimes,
    run: &RunSettings,
) -> Result<OffsetResult, Error> {
    for halvings in 0.. {
        let result = on_lattice(distance, settings, &band_settings, times, run);
        let finer = finer(distance, settings, &band_settings).filter(|_| halvings < settings.resolve);
        match (result, finer) {
            (Ok(result), Some(finer)) if result.statistics.unseen.count() > 0 => {
                times = result.statistics.times;
                band_settings = finer;
            }
            // All of it is unseen.
            (Err(Error::Empty(EmptyResult::TooThin { .. })), Some(finer)) => band_settings = finer,
            (Ok(mut result), _) => {
                result.statistics.halvings = halvings;
                return Ok(result);
            }
            (Err(error), _) => return Err(error),
        }
    }
    unreachable!("the settings limit the halvings")
}

/// The lattice with half the voxel size, if its indices and its band fit.
fn finer(
    distance: &SignedDistance,
    settings: &OffsetSettings,
    band_settings: &BandSettings,
) -> Option<BandSettings> {
    let lattice = Lattice { voxel: 0.5 * band_settings.lattice.voxel };
    let finer = BandSettings { lattice, ..*band_settings };
    settings.check_range(distance.mesh(), &finer).ok()?;
    unsuitable::check_memory(distance.mesh(), &finer, settings.max_memory).ok()?;
    Some(finer)
}
