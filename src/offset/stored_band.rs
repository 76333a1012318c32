//! The band in OpenVDB, as it grows.

use super::{BandOptions, OffsetSettings};
use crate::band::narrow_band::{BandStore, StoredPart};
use crate::band::{BandSettings, LeafBatch};
use crate::filter::Block;
use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE, Slab};
pub(crate) use crate::vdb::Band;
use crate::vdb::{ClosestGrid, SurfaceGrid, VdbError};

impl StoredPart {
    /// Returns the part that is stored by these settings.
    pub(super) fn by(settings: &OffsetSettings) -> StoredPart {
        match settings.band {
            None => StoredPart::Nothing,
            Some(BandOptions { closest: false, .. }) => StoredPart::LevelSet,
            Some(BandOptions { closest: true, .. }) => StoredPart::WithClosest,
        }
    }
}

/// A band that is being filled.
#[derive(Debug)]
pub(crate) struct StoredBand {
    surface: SurfaceGrid,
    /// Only where it was asked for.
    closest: Option<ClosestGrid>,
}

impl StoredBand {
    /// Returns the empty band that the settings ask for.
    pub(crate) fn wanted(
        band: &BandSettings,
        settings: &OffsetSettings,
    ) -> Result<Option<StoredBand>, VdbError> {
        settings.band.as_ref().map(|options| StoredBand::new(band, options)).transpose()
    }

    pub(crate) fn new(band: &BandSettings, options: &BandOptions) -> Result<StoredBand, VdbError> {
        Ok(StoredBand {
            surface: SurfaceGrid::new(band.lattice, band.half_width)?,
            closest: options.closest.then(|| ClosestGrid::new(band.lattice)).transpose()?,
        })
    }

    /// The finished band.
    pub(crate) fn finish(mut self) -> Band {
        self.surface.prune();
        Band { surface: self.surface, closest: self.closest }
    }
}

impl<E: From<VdbError>> BandStore<E> for StoredBand {
    fn stored_part(&self) -> StoredPart {
        if self.closest.is_some() { StoredPart::WithClosest } else { StoredPart::LevelSet }
    }

    fn insert(&mut self, batch: &LeafBatch, slab: Slab) -> Result<(), E> {
        // Runs of leaves that are owned: all of them, unless the batch crosses a plane between
        // slabs.
        let mut start = 0;
        for run in batch.origins.chunk_by(|&a, &b| slab.owns(a) == slab.owns(b)) {
            let end = start + run.len();
            if slab.owns(run[0]) {
                let nodes = start * LEAF_SIZE..end * LEAF_SIZE;
                let active = &batch.active[start..end];
                self.surface.insert_leaves(run, &batch.values[nodes.clone()], active)?;
                if let Some(closest) = &mut self.closest {
                    closest.insert_leaves(run, &batch.closest[nodes], active)?;
                }
            }
            start = end;
        }
        let (mut origins, mut sides) = (Vec::new(), Vec::new());
        for &(origin, side) in &batch.inside_blocks {
            owned_parts(Block { origin, width: side }, slab, &mut |block| {
                origins.push(block.origin);
                sides.push(block.width as u32);
            });
        }
        Ok(self.surface.fill_inside(&origins, &sides)?)
    }
}

/// The largest blocks that make up what `slab` owns of a block.
fn owned_parts(block: Block, slab: Slab, visit: &mut impl FnMut(Block)) {
    let last = block.origin + Ijk::new(block.width - LEAF_DIM, 0, 0);
    if slab.owns(block.origin) && slab.owns(last) {
        visit(block);
    } else if slab.meets(block.origin, block.width) {
        block.children().into_iter().for_each(|child| owned_parts(child, slab, visit));
    }
}
