//! The band's way into OpenVDB and back.

use crate::band::{self, BandSettings, LeafBatch, LeafMask, SignField, inside_mask};
use crate::candidates::CandidateLists;
use crate::distance::SignedDistance;
use crate::edge::NodeTriangles;
use crate::error::Error;
use crate::filter::FilterStatistics;
use crate::lattice::{Ijk, LEAF_SIZE};
use crate::run::RunSettings;
use crate::vdb::{Band, ClosestGrid, SurfaceGrid};

/// Builds the band into OpenVDB grids: `surface` with phi and `closest` with triangle numbers. With it come the lists of
/// the triangles near the surface.
pub(crate) fn build(
    distance: &SignedDistance,
    settings: &BandSettings,
    run: &RunSettings,
) -> Result<(Band, CandidateLists, FilterStatistics), Error> {
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
    let mut lists = Vec::new();
    let statistics = band::build(distance, settings, run, |mut batch| {
        inside_blocks.extend_from_slice(&batch.inside_blocks);
        insert(&batch)?;
        lists.push((std::mem::take(&mut batch.origins), std::mem::take(&mut batch.lists)));
        Ok::<_, Error>(())
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
    let lists = CandidateLists::new(settings.lattice, lists);
    Ok((Band { surface, closest: Some(closest) }, lists, statistics))
}

/// Leaves read at a time: enough to keep the bridge's overhead away, little enough to stay in cache.
const LEAVES_PER_READ: usize = 256;

/// Reads signs and closest triangles of a band back from OpenVDB, as from any stored band.
pub(crate) fn read_back(band: &Band, run: &RunSettings) -> Result<(SignField, NodeTriangles), Error> {
    let (signs, closest) =
        run.install(|| rayon::join(|| read_signs(&band.surface), || read_closest(band.closest.as_ref())));
    let (signs, (origins, ids)) = (signs?, closest?);
    let triangles = NodeTriangles::new(&signs, &origins, ids);
    Ok((signs, triangles))
}

fn read_signs(surface: &SurfaceGrid) -> Result<SignField, Error> {
    let origins = surface.leaf_origins();
    let mut inside: Vec<LeafMask> = Vec::with_capacity(origins.len());
    let mut values = vec![0.0; LEAVES_PER_READ * LEAF_SIZE];
    let mut active = vec![[0; 8]; LEAVES_PER_READ];
    for first in (0..origins.len()).step_by(LEAVES_PER_READ) {
        let count = LEAVES_PER_READ.min(origins.len() - first);
        let values = &mut values[..count * LEAF_SIZE];
        surface.read_leaves(first, values, &mut active[..count])?;
        inside.extend(values.chunks_exact(LEAF_SIZE).map(inside_mask));
    }
    SignField::new(&origins, &inside, |missing| Ok(surface.inside_at(missing)))
}

/// The leaves of the closest triangles, and 512 numbers for each; none without a grid.
fn read_closest(closest: Option<&ClosestGrid>) -> Result<(Vec<Ijk>, Vec<i32>), Error> {
    let Some(closest) = closest else { return Ok((Vec::new(), Vec::new())) };
    let origins = closest.leaf_origins();
    let mut ids = vec![-1; origins.len() * LEAF_SIZE];
    let mut active = vec![[0; 8]; origins.len()];
    closest.read_leaves(0, &mut ids, &mut active)?;
    Ok((origins, ids))
}
