//! The band as the edges and the contour need it, in plain arrays; and into OpenVDB, where it is to be kept.

use super::stored_band::StoredBand;
use crate::band::{self, BandSettings, InsideBlocks, LeafBatch, LeafMask, SignField};
use crate::candidates::{BlockLists, CandidateLists};
use crate::distance::SignedDistance;
use crate::edge::{NearTriangles, NodeTriangles, PartTriangles};
use crate::error::Error;
use crate::filter::FilterStatistics;
use crate::lattice::Ijk;
use crate::run::RunSettings;

/// The band around the offset surface.
pub(crate) struct NarrowBand {
    /// Which nodes are inside.
    pub(crate) signs: SignField,
    /// The closest triangles of its nodes, and those near its edges.
    pub(crate) near: NearTriangles,
    /// What making it took.
    pub(crate) counts: BandCounts,
}

/// The work of the filters, and the size of what the slab owns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BandCounts {
    pub(crate) filter: FilterStatistics,
    pub(crate) active_voxels: u64,
    pub(crate) leaves: u64,
}

/// What is asked of the leaves once they are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// Edges and a contour.
    Contour,
    /// Nothing: they are only stored.
    Nothing,
}

/// Builds the band, and adds what the slab owns to `stored`.
pub(crate) fn build(
    distance: &SignedDistance,
    settings: &BandSettings,
    stored: Option<&mut StoredBand>,
    run: &RunSettings,
) -> Result<NarrowBand, Error> {
    let (parts, counts) = Parts::collect(distance, settings, Next::Contour, stored, run)?;
    run.install(|| {
        let ring = |nodes: &[Ijk]| Ok::<_, Error>(parts.blocks.contain(nodes));
        let signs = SignField::new(&parts.origins, &parts.inside, settings.slab, ring)?;
        let nodes = NodeTriangles::new(&signs, &parts.origins, parts.closest);
        let lists = CandidateLists::new(settings.lattice, parts.lists);
        Ok(NarrowBand { signs, near: NearTriangles { nodes, lists: Some(lists) }, counts })
    })
}

/// Builds the band into `stored` only.
pub(crate) fn store(
    distance: &SignedDistance,
    settings: &BandSettings,
    stored: &mut StoredBand,
    run: &RunSettings,
) -> Result<BandCounts, Error> {
    Ok(Parts::collect(distance, settings, Next::Nothing, Some(stored), run)?.1)
}

/// Leaves as they come out of the filters.
#[derive(Default)]
struct Parts {
    origins: Vec<Ijk>,
    inside: Vec<LeafMask>,
    closest: Vec<PartTriangles>,
    lists: Vec<(Vec<Ijk>, BlockLists)>,
    blocks: InsideBlocks,
}

impl Parts {
    fn collect(
        distance: &SignedDistance,
        settings: &BandSettings,
        next: Next,
        mut stored: Option<&mut StoredBand>,
        run: &RunSettings,
    ) -> Result<(Parts, BandCounts), Error> {
        let mut parts = Parts::default();
        let mut counts = BandCounts::default();
        let mut inside_blocks = Vec::new();
        let mut take = |batch: LeafBatch, parts: &mut Parts| -> Result<(), Error> {
            if let Some(stored) = &mut stored {
                stored.insert(&batch, settings.slab)?;
            }
            for (_, active) in batch.origins.iter().zip(&batch.active).filter(|l| settings.slab.owns(*l.0)) {
                counts.leaves += 1;
                counts.active_voxels += active.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
            }
            parts.take(batch, next);
            Ok(())
        };
        counts.filter = band::build(distance, settings, run, |batch| {
            inside_blocks.extend_from_slice(&batch.inside_blocks);
            take(batch, &mut parts)
        })?;
        let jumps = run.install(|| {
            parts.blocks = InsideBlocks::new(&inside_blocks);
            let inside_at = |nodes: &[Ijk]| parts.blocks.contain(nodes);
            band::leaves_at_jumps(&parts.origins, &inside_blocks, settings, inside_at)
        });
        if !jumps.is_empty() {
            take(jumps, &mut parts)?;
        }
        Ok((parts, counts))
    }

    fn take(&mut self, batch: LeafBatch, next: Next) {
        self.origins.extend_from_slice(&batch.origins);
        if next == Next::Contour {
            self.inside.extend(batch.inside);
            self.closest.push(PartTriangles::new(&batch.closest));
            // Leaves that were added where the sign jumps have no lists: edges there ask the hierarchy.
            if !batch.lists.is_empty() {
                let mut lists = batch.lists;
                lists.shrink_to_fit();
                self.lists.push((batch.origins, lists));
            }
        }
    }
}
