//! The stages on one slab of the lattice, or on all of it.

use super::stored_band::StoredBand;
use super::surface::OffsetSurface;
use super::{OffsetError, OffsetSettings, OffsetStatistics};
use crate::band::narrow_band::{self, BandStore, NarrowBand};
use crate::band::{BandSettings, NearTriangles, grid_nodes};
use crate::contour::{ContourSettings, MAX_TRIANGLE_REACH, SlabContour, contour_slab};
use crate::distance::SignedDistance;
use crate::edge::{EdgeNumbers, EdgeSettings, RootMethod, solve_by};
use crate::geom::aabb::Aabb;
use crate::run::RunSettings;
use crate::subvoxel::{self, MissedCandidates};
use glam::DVec3;
use std::time::Instant;

/// The contour of a slab, and what it lacks; `None` when the surface passes nowhere near the slab.
/// What the slab owns is added to `stored` and to the statistics.
pub(super) fn run_stages(
    distance: &SignedDistance,
    settings: &OffsetSettings,
    band_settings: &BandSettings,
    stored: Option<&mut StoredBand>,
    statistics: &mut OffsetStatistics,
    run: &RunSettings,
) -> Result<Option<(SlabContour, MissedCandidates)>, OffsetError> {
    let BandSettings { lattice, r, slab, .. } = *band_settings;
    let store = stored.map(|stored| -> &mut (dyn BandStore<OffsetError> + Send) { stored });
    let started = Instant::now();
    let NarrowBand { signs, near, counts } = narrow_band::build(distance, band_settings, store, run)?;
    statistics.add_band(&counts);
    statistics.times.band += started.elapsed().as_secs_f64();

    let started = Instant::now();
    let numbers = run.install(|| EdgeNumbers::new(&signs))?;
    if numbers.is_empty() {
        return Ok(None);
    }
    let edge_settings = EdgeSettings { lattice, r, method: RootMethod::TriangleIteration, slab };
    let (crossings, edges) = solve_by(distance, &edge_settings, &signs, numbers, &near, run)?;
    statistics.edges += edges;
    let suspects = subvoxel::find_missed(distance, r, lattice, slab, &signs, &near, run)?;
    let NearTriangles { nodes, lists } = near;
    drop(nodes);
    statistics.times.edges += started.elapsed().as_secs_f64();

    let started = Instant::now();
    let contour_settings =
        ContourSettings { slab, extent: Some(reach(distance, band_settings)), ..settings.contour(lattice) };
    let surface = OffsetSurface { distance, r, lists: lists.as_ref(), vanishing: 1e-4 * lattice.voxel };
    let contour = contour_slab(&signs, &crossings, lattice, Some(&surface), &contour_settings, run)?;
    drop((crossings, lists));
    let contour = run.install(|| contour.into_ordered());
    let triangles = contour.firsts.windows(2).map(|ends| ends[0]..ends[1]);
    let leaves = signs.leaves().map(|leaf| signs.origin(leaf)).zip(triangles);
    let lost = subvoxel::confirm_missed(suspects, &contour.mesh, leaves, MAX_TRIANGLE_REACH, run)?;
    statistics.contour += contour.statistics;
    statistics.times.contour += started.elapsed().as_secs_f64();
    Ok(Some((contour, lost)))
}

/// The largest index, in size, of a node that the contour can reach, wherever its slab is: how
/// coordinates are rounded must not depend on the slab.
fn reach(distance: &SignedDistance, settings: &BandSettings) -> u32 {
    let bounds = Aabb::around(distance.mesh().vertices.iter().map(|&v| DVec3::from(v)));
    let ends = grid_nodes(bounds, settings);
    ends.iter().flat_map(|end| end.0).map(i32::unsigned_abs).max().unwrap_or(0)
}
