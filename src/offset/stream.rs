//! An offset slab by slab: in less memory than the whole takes, or one share of it on a machine of its own.

use super::error::EmptyResult;
use super::memory::{MemoryError, check_countable, leaves_within};
use super::stages::on_slab;
use super::stored_band::StoredBand;
use super::voxel_refinement::until_seen;
use super::{OffsetError, OffsetResult, OffsetSettings, OffsetStatistics, Prepared};
use crate::band::{BandSettings, count_layers};
use crate::contour::{SlabContour, halo};
use crate::lattice::Slab;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::subvoxel::{MissedCandidates, MissedFeatures};
use std::time::Instant;

/// How the lattice is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Into slabs that are worked off one after the other, each within about this many bytes.
    Memory(u64),
    /// Into `of` tiles with about the same share of the surface each, of which tile `number`, 1 to `of`, is made.
    Tile {
        /// Which one.
        number: u32,
        /// How many there are.
        of: u32,
    },
}

/// The error of a receiver of a streamed mesh.
pub type SinkError = Box<dyn std::error::Error + Send + Sync>;

/// Takes the pieces of the result of [`offset_in_slabs`], in their order.
pub trait PieceSink {
    /// Forgets all pieces: they come again on a finer lattice.
    ///
    /// # Errors
    /// What ends the run.
    fn restart(&mut self) -> Result<(), SinkError>;

    /// Takes the next piece. Its vertices and triangles follow those of the piece before.
    ///
    /// # Errors
    /// What ends the run.
    fn piece(&mut self, piece: &SlabContour) -> Result<(), SinkError>;
}

/// The same as [`offset`](super::offset()), in slabs. The pieces, one after the other, are the mesh that it returns; the
/// mesh of the result stays empty. With a tile, the statistics and the band are the tile's.
///
/// # Errors
/// As [`offset`](super::offset()); what `sink` returns; [`OffsetError::Memory`] when no slab is thin enough for the memory. A
/// tile that the surface does not pass is no error.
///
/// # Panics
/// When a tile's number is not one of its tiles'.
pub fn offset_in_slabs(
    mesh: &TriMesh,
    settings: &OffsetSettings,
    cut: Cut,
    sink: &mut dyn PieceSink,
    run: &RunSettings,
) -> Result<OffsetResult, OffsetError> {
    if let Cut::Tile { number, of } = cut {
        assert!((1..=of).contains(&number), "there is no tile {number} of {of}");
    }
    Prepared::with(mesh, settings, run, |prepared| {
        let Prepared { distance, settings, run, .. } = *prepared;
        let on_lattice = |band_settings: &BandSettings, times| -> Result<OffsetResult, OffsetError> {
            sink.restart().map_err(sink_error)?;
            let mut statistics = OffsetStatistics::new(band_settings, times);
            let stored = || StoredBand::new(band_settings, settings);
            let mut stored = settings.keep_band.then(stored).transpose()?;
            let started = Instant::now();
            let slabs = cut_slabs(prepared, band_settings, cut)?;
            statistics.times.band += started.elapsed().as_secs_f64();
            let mut lost = MissedCandidates::default();
            let mut is_empty = true;
            for &slab in &slabs {
                let band_settings = BandSettings { slab, ..*band_settings };
                let done =
                    on_slab(distance, settings, &band_settings, stored.as_mut(), &mut statistics, run)?;
                if let Some((contour, of_slab)) = done {
                    is_empty &= contour.triangles.is_empty();
                    lost.append(of_slab);
                    sink.piece(&contour).map_err(sink_error)?;
                }
            }
            if is_empty && matches!(cut, Cut::Memory(_)) {
                return Err(EmptyResult::explain(distance, band_settings, run)?.into());
            }
            statistics.slabs = slabs.len();
            statistics.missed = MissedFeatures::new(lost);
            let band = stored.map(StoredBand::finish);
            statistics.set_memory(band.as_ref());
            Ok(OffsetResult { mesh: TriMesh::default(), band, statistics })
        };
        until_seen(prepared, |_| true, on_lattice)
    })
}

/// A receiver that was cancelled has cancelled the run.
fn sink_error(error: SinkError) -> OffsetError {
    if error.is::<Cancelled>() { OffsetError::Cancelled } else { OffsetError::Sink(error) }
}

/// The slabs to work off.
fn cut_slabs(prepared: &Prepared<'_>, settings: &BandSettings, cut: Cut) -> Result<Vec<Slab>, OffsetError> {
    let Prepared { distance, run, .. } = *prepared;
    check_countable(distance.mesh(), settings)?;
    let halo = halo(&prepared.settings.contour(settings.lattice));
    let layers = count_layers(distance, settings, run)?;
    Ok(match cut {
        Cut::Tile { number, of } => vec![super::partition::share(&layers, halo, number, of)],
        // Nothing to see there, and that is said.
        Cut::Memory(_) if layers.leaves.is_empty() => vec![Slab::WHOLE],
        Cut::Memory(bytes) => {
            let most = leaves_within(distance.mesh(), bytes);
            super::partition::within(&layers, halo, most)
                .map_err(|leaves| MemoryError::of_slabs(distance.mesh(), settings, leaves, bytes))?
        }
    })
}
