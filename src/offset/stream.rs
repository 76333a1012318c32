//! An offset slab by slab: in less memory than the whole takes, or one share of it on a machine of
//! its own.

use super::error::MemoryError;
use super::memory::{check_countable, leaves_within};
use super::partition;
use super::prepared::Prepared;
use super::stages::run_stages;
use super::stored_band::StoredBand;
use super::voxel_refinement::refine_until_resolved;
use super::{EmptyResult, OffsetError, OffsetSettings, OffsetStatistics, StreamResult};
use crate::band::{BandSettings, count_layers};
use crate::contour::halo;
use crate::io::MeshStream;
use crate::lattice::Slab;
use crate::mesh::{MeshChunk, TriMesh};
use crate::quantity::TileIndex;
use crate::run::{Cancelled, RunSettings};
use crate::subvoxel::{MissedCandidates, MissedFeatures};
use std::error::Error;
use std::time::Instant;

/// The way in which the lattice is divided into slabs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partition {
    /// Slabs that are worked off one after the other, each within about this many bytes.
    Memory(u64),
    /// Tiles with about the same share of the surface each, of which this one is made.
    Tile(TileIndex),
}

/// A receiver of the chunks of a streamed mesh, in their order.
pub trait MeshSink {
    /// Forgets all chunks: they come again on a finer lattice. Called once before the first chunk,
    /// too.
    ///
    /// # Errors
    /// Whatever ends the run.
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>>;

    /// Takes the next chunk. Its vertices and triangles follow those of the chunk before.
    ///
    /// # Errors
    /// Whatever ends the run.
    fn chunk(&mut self, chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>>;
}

impl MeshSink for MeshStream {
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(self.clear()?)
    }

    fn chunk(&mut self, chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(self.append(chunk)?)
    }
}

/// Makes an offset in slabs, and hands its mesh to `sink` chunk by chunk.
///
/// The chunks, one after the other, are the mesh that [`offset`](super::offset()) returns. With a
/// tile, the statistics and the band are the tile's.
///
/// # Errors
/// As [`offset`](super::offset()); [`OffsetError::Sink`] when `sink` fails;
/// [`OffsetError::Memory`] when no slab is thin enough for the memory. A tile that the surface does
/// not pass is no error.
pub fn offset_streamed(
    mesh: &TriMesh,
    settings: &OffsetSettings,
    partition: Partition,
    sink: &mut dyn MeshSink,
    run: &RunSettings,
) -> Result<StreamResult, OffsetError> {
    Prepared::with(mesh, settings, run, |prepared| {
        let Prepared { distance, settings, run, .. } = *prepared;
        let on_lattice = |band_settings: &BandSettings, times| {
            sink.restart().map_err(sink_error)?;
            let mut statistics = OffsetStatistics::new(band_settings, times);
            let mut stored = StoredBand::wanted(band_settings, settings)?;
            let started = Instant::now();
            let slabs = slabs(prepared, band_settings, partition)?;
            statistics.times.band += started.elapsed().as_secs_f64();
            let mut lost = MissedCandidates::default();
            let mut is_empty = true;
            let mut first_vertex = 0;
            for &slab in &slabs {
                let band_settings = BandSettings { slab, ..*band_settings };
                let done =
                    run_stages(distance, settings, &band_settings, stored.as_mut(), &mut statistics, run)?;
                if let Some((contour, of_slab)) = done {
                    is_empty &= contour.triangles.is_empty();
                    lost.append(of_slab);
                    let (vertices, triangles) = (contour.vertices, contour.triangles);
                    let next = first_vertex + vertices.len() as u64;
                    let first = match partition {
                        Partition::Memory(_) => first_vertex,
                        Partition::Tile(_) => vertices.start as u64,
                    };
                    let chunk = MeshChunk::new(&contour.mesh, vertices, triangles, first);
                    sink.chunk(&chunk).map_err(sink_error)?;
                    first_vertex = next;
                }
            }
            if is_empty && matches!(partition, Partition::Memory(_)) {
                return Err(EmptyResult::explain(distance, band_settings, run)?.into());
            }
            statistics.slabs = slabs.len();
            statistics.missed = MissedFeatures::new(lost);
            let band = stored.map(StoredBand::finish);
            statistics.set_memory(band.as_ref());
            Ok((band, statistics))
        };
        let (band, statistics) = refine_until_resolved(prepared, |_| true, on_lattice)?;
        #[cfg(not(feature = "openvdb"))]
        let _ = band;
        Ok(StreamResult {
            #[cfg(feature = "openvdb")]
            band,
            statistics,
        })
    })
}

/// Converts the error of a sink: one that was cancelled has cancelled the run.
fn sink_error(error: Box<dyn Error + Send + Sync>) -> OffsetError {
    if error.is::<Cancelled>() { OffsetError::Cancelled } else { OffsetError::Sink(error) }
}

/// Returns the slabs to work off.
fn slabs(
    prepared: &Prepared<'_>,
    settings: &BandSettings,
    partition: Partition,
) -> Result<Vec<Slab>, OffsetError> {
    let Prepared { distance, run, .. } = *prepared;
    check_countable(distance.mesh(), settings)?;
    let halo = halo(&prepared.settings.contour(settings.lattice));
    let layers = count_layers(distance, settings, run)?;
    Ok(match partition {
        Partition::Tile(tile) => vec![partition::share(&layers, halo, tile)],
        // Nothing to see there, and that is said.
        Partition::Memory(_) if layers.leaves.is_empty() => vec![Slab::WHOLE],
        Partition::Memory(bytes) => {
            let most = leaves_within(distance.mesh(), bytes);
            partition::within(&layers, halo, most)
                .map_err(|leaves| MemoryError::of_slabs(distance.mesh(), settings, leaves, bytes))?
        }
    })
}
