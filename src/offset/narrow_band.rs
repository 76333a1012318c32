//! The band's way into OpenVDB and back.

use crate::band::{self, BandSettings, LeafBatch, LeafMask, SignField, inside_mask};
use crate::distance::SignedDistance;
use crate::edge::NodeTriangles;
use crate::error::Error;
use crate::filter::FilterStatistics;
use crate::lattice::LEAF_SIZE;
use crate::run::RunSettings;
use crate::vdb::{Band, ClosestGrid, SurfaceGrid};

/// Builds the band into OpenVDB grids: `surface` with phi and `closest` with triangle numbers.
pub(crate) fn build(
    distance: &SignedDistance,
    settings: &BandSettings,
    run: &RunSettings,
) -> Result<(Band, FilterStatistics), Error> {
    let mut surface = SurfaceGrid::new(settings.lattice, settings.half_width)?;
    let mut closest = ClosestGrid::new(settings.lattice)?;
    let mut insert = |batch: &LeafBatch| -> Result<(), Error> {
        surface.insert_leaves(&batch.origins, &batch.values, &batch.active)?;
        closest.insert_leaves(&batch.origins, &batch.closest, &batch.active)?;
        let (origins, sides): (Vec<_>, Vec<_>) =
            batch.inside_blocks.iter().map(|&(origin, side)| (origin, side as u32)).unzip();
        Ok(surface.fill_inside(&origins, &sides)?)
    };
    let mut inside_blocks = Vec::new();
    let statistics = band::build(distance, settings, run, |batch| {
        inside_blocks.extend_from_slice(&batch.inside_blocks);
        insert(&batch)
    })?;
    let leaves = surface.leaf_origins();
    let jumps = band::leaves_at_jumps(&leaves, &inside_blocks, settings.background(), |nodes| {
        surface.inside_at(nodes)
    });
    if !jumps.origins.is_empty() {
        surface.insert_leaves(&jumps.origins, &jumps.values, &jumps.active)?;
        closest.insert_leaves(&jumps.origins, &jumps.closest, &jumps.active)?;
    }
    surface.prune();
    Ok((Band { surface, closest: Some(closest) }, statistics))
}

/// Leaves read at a time: enough to keep the bridge's overhead away, little enough to stay in cache.
const LEAVES_PER_READ: usize = 256;

/// Reads signs and closest triangles of a band back from OpenVDB, as from any stored band.
pub(crate) fn read_back(band: &Band) -> Result<(SignField, NodeTriangles), Error> {
    let origins = band.surface.leaf_origins();
    let mut inside: Vec<LeafMask> = Vec::with_capacity(origins.len());
    let mut values = vec![0.0; LEAVES_PER_READ * LEAF_SIZE];
    let mut active = vec![[0; 8]; LEAVES_PER_READ];
    for first in (0..origins.len()).step_by(LEAVES_PER_READ) {
        let count = LEAVES_PER_READ.min(origins.len() - first);
        let values = &mut values[..count * LEAF_SIZE];
        band.surface.read_leaves(first, values, &mut active[..count])?;
        inside.extend(values.chunks_exact(LEAF_SIZE).map(inside_mask));
    }
    let signs = SignField::new(&origins, &inside, |missing| Ok::<_, Error>(band.surface.inside_at(missing)))?;

    let Some(closest) = &band.closest else { return Ok((signs, NodeTriangles::default())) };
    let origins = closest.leaf_origins();
    let mut ids = vec![-1; origins.len() * LEAF_SIZE];
    let mut active = vec![[0; 8]; origins.len()];
    closest.read_leaves(0, &mut ids, &mut active)?;
    let triangles = NodeTriangles::new(&signs, &origins, ids);
    Ok((signs, triangles))
}
