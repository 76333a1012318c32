//! The share of the offset surface in each layer of leaves, by the coarse filters, for the choice
//! of slabs.

use super::build::{BandSettings, Plan};
use crate::distance::SignedDistance;
use crate::filter::{FilterSettings, FilterStatistics, Verdict};
use crate::lattice::LEAF_DIM;
use crate::run::{Cancelled, RunSettings};
use rayon::prelude::*;

/// Leaves that the coarse filters keep, by layer along x.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    /// Coordinate of the first layer's first node along x.
    pub first: i32,
    /// Number of leaves in each layer of eight nodes. A few leaves turn out to hold no node of the
    /// band.
    pub leaves: Vec<u64>,
}

impl Layers {
    /// Returns the number of leaves in all layers.
    pub fn total(&self) -> u64 {
        self.leaves.iter().sum()
    }
}

/// Applies the filters down to leaves, and counts the leaves that they keep. Counting takes a few
/// percent of the work of the band.
///
/// # Errors
/// Cancellation.
pub fn count_layers(
    distance: &SignedDistance,
    settings: &BandSettings,
    run: &RunSettings,
) -> Result<Layers, Cancelled> {
    let Plan { filter, boxes, .. } = Plan::new(distance, settings, &FilterSettings::default());
    let per_box: Vec<Vec<i32>> = run.install(|| {
        boxes
            .par_iter()
            .with_max_len(1)
            .map(|&block| {
                run.check()?;
                let mut ignored = FilterStatistics::default();
                let mut kept = Vec::new();
                match filter.bounding_box(block, &mut ignored) {
                    Verdict::Outside | Verdict::Inside => {}
                    Verdict::Kept { .. } if block.width == LEAF_DIM => kept.push(block.origin.0[0]),
                    Verdict::Kept { triangle, .. } => {
                        filter.octree(block, triangle, LEAF_DIM, &mut ignored, &mut |leaf, verdict| {
                            if matches!(verdict, Verdict::Kept { .. }) {
                                kept.push(leaf.origin.0[0]);
                            }
                        });
                    }
                }
                Ok(kept)
            })
            .collect::<Result<_, Cancelled>>()
    })?;
    let all = || per_box.iter().flatten().copied();
    let (Some(first), Some(last)) = (all().min(), all().max()) else { return Ok(Layers::default()) };
    let mut leaves = vec![0; ((last - first) / LEAF_DIM) as usize + 1];
    for x in all() {
        leaves[((x - first) / LEAF_DIM) as usize] += 1;
    }
    Ok(Layers { first, leaves })
}
