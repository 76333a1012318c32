//! All intersected edges of a band, in parallel over its leaves.

use super::hybrid::Solver;
use super::leaf_edges::LeafSolver;
use super::settings::{EdgeSettings, RootMethod};
use super::statistics::EdgeStatistics;
use super::{Crossing, Crossings, EdgeNumbers};
use crate::band::{LeafId, NearTriangles, SignField};
use crate::distance::SignedDistance;
use crate::lattice::{Lattice, Slab};
use crate::run::{Cancelled, Phase, RunSettings, SHARE};
use rayon::prelude::*;

/// Returns the intersections of the edges numbered by `numbers` with the surface at distance `r`.
///
/// # Errors
/// Cancellation.
pub fn solve(
    distance: &SignedDistance,
    lattice: Lattice,
    r: f64,
    signs: &SignField,
    numbers: EdgeNumbers,
    near: &NearTriangles,
    run: &RunSettings,
) -> Result<(Crossings, EdgeStatistics), Cancelled> {
    let settings = EdgeSettings { lattice, r, method: RootMethod::TriangleIteration, slab: Slab::WHOLE };
    solve_by(distance, &settings, signs, numbers, near, run)
}

/// Returns the intersections that [`solve`] returns, found by the method that the settings name.
///
/// # Errors
/// Cancellation.
pub fn solve_by(
    distance: &SignedDistance,
    settings: &EdgeSettings,
    signs: &SignField,
    numbers: EdgeNumbers,
    near: &NearTriangles,
    run: &RunSettings,
) -> Result<(Crossings, EdgeStatistics), Cancelled> {
    let EdgeSettings { lattice, r, method, slab } = *settings;
    let solver = Solver { distance, r, voxel: lattice.voxel };
    // Not touched before the threads do.
    let mut samples: Vec<Crossing> = bytemuck::zeroed_vec(numbers.len());
    let mut rest: &mut [Crossing] = &mut samples;
    let mut tasks: Vec<(LeafId, &mut [Crossing])> = Vec::new();
    for leaf in signs.leaves() {
        let (own, others) = rest.split_at_mut(numbers.range(leaf).len());
        rest = others;
        if !own.is_empty() {
            tasks.push((leaf, own));
        }
    }
    let phase = run.phase(Phase::Edges, tasks.len() as u64);
    let leaf = LeafSolver { solver, method, lattice, signs, numbers: &numbers, near };
    let statistics = run.install(|| {
        tasks
            .into_par_iter()
            .with_max_len(SHARE)
            .map(|(id, samples)| {
                phase.advance(1)?;
                let counts = leaf.solve(id, samples);
                Ok(if slab.owns(signs.origin(id)) { counts } else { EdgeStatistics::default() })
            })
            .try_reduce(EdgeStatistics::default, |mut a, b| {
                a += b;
                Ok(a)
            })
    })?;
    Ok((Crossings { numbers, samples }, statistics))
}
