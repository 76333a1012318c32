//! What every operation begins with: the input is checked, and its hierarchy built.

use super::{EngineTimes, OffsetError, OffsetSettings, error};
use crate::band::BandSettings;
use crate::distance::SignedDistance;
use crate::mesh::{Topology, TriMesh};
use crate::run::{Phase, RunSettings};
use std::time::Instant;

/// The input, ready for work on a lattice.
#[derive(Clone, Copy)]
pub(super) struct Prepared<'a> {
    pub distance: &'a SignedDistance<'a>,
    pub settings: &'a OffsetSettings,
    /// The lattice that was asked for.
    pub band_settings: BandSettings,
    /// The time spent so far.
    pub times: EngineTimes,
    pub run: &'a RunSettings,
}

impl Prepared<'_> {
    /// Checks the input, builds its hierarchy, and hands both to `work`.
    pub fn with<T>(
        mesh: &TriMesh,
        settings: &OffsetSettings,
        run: &RunSettings,
        work: impl FnOnce(&Prepared<'_>) -> Result<T, OffsetError>,
    ) -> Result<T, OffsetError> {
        error::check_mesh(mesh)?;
        let topology = run.install(|| Topology::new(mesh));
        error::check_input(mesh, &topology, settings.open_input)?;
        let band_settings = settings.in_model_units(mesh)?;
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
