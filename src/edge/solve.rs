//! All intersected edges of a band, in parallel over its leaves.

use super::hybrid::{Solver, TOLERANCE};
use super::leaf::LeafSolver;
use super::statistics::EdgeStatistics;
use super::{Crossing, Crossings, EdgeNumbers, NodeTriangles};
use crate::band::{LeafId, SignField};
use crate::candidates::CandidateLists;
use crate::distance::SignedDistance;
use crate::lattice::{Lattice, Slab};
use crate::run::{Cancelled, Phase, RunSettings, SHARE};
use rayon::prelude::*;

/// What is known of the triangles that are near the edges.
#[derive(Clone, Debug, Default)]
pub struct NearTriangles {
    /// The closest triangles of the band's nodes.
    pub nodes: NodeTriangles,
    /// All triangles that can be closest to the points of an edge; without, the hierarchy is asked.
    pub lists: Option<CandidateLists>,
}

/// How the intersection of an edge is found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RootMethod {
    /// In closed form on the triangle that is closest where the last one had its root.
    #[default]
    Following,
    /// The method of \[LW11\]: in closed form where both ends share a triangle, with halving between attempts.
    Hybrid,
    /// By halving only, until abs(phi) is at most `tolerance` voxels: the measure that Table V of \[LW11\]
    /// holds against the hybrid method.
    Bisection {
        /// In voxels, positive.
        tolerance: f64,
    },
}

impl RootMethod {
    /// Bisection to the tolerance of the hybrid method.
    pub const PLAIN_BISECTION: RootMethod = RootMethod::Bisection { tolerance: TOLERANCE };
}

/// Which surface to intersect with, on which lattice, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSettings {
    /// The lattice.
    pub lattice: Lattice,
    /// The offset distance r in model units.
    pub r: f64,
    /// The way to the roots.
    pub method: RootMethod,
    /// The part of the lattice whose edges are counted; all are intersected.
    pub slab: Slab,
}

/// The intersections of the edges numbered by `numbers` with the surface at distance `r`.
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
    let settings = EdgeSettings { lattice, r, method: RootMethod::Following, slab: Slab::WHOLE };
    solve_by(distance, &settings, signs, numbers, near, run)
}

/// The same as [`solve`], by the method that the settings name.
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
