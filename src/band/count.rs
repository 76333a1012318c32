//! Counts the distance computations of a band without doing those at its nodes (\[LW11\] Table IV).

use super::build::{BandSettings, Plan};
use crate::distance::SignedDistance;
use crate::filter::{FilterSettings, FilterStatistics, Switch, Verdict};
use crate::run::{Cancelled, RunSettings};
use rayon::prelude::*;

/// Width of the smallest blocks of the octree filter, in nodes, as in the build.
const MIN_BLOCK_WIDTH: i32 = 2;

/// Returns the counts that [`build_filtered`](super::build_filtered) would return.
///
/// The nodes of a kept block are counted and not evaluated, so tens of millions of queries cost
/// nothing. `valid_nodes` stays 0 for that reason.
///
/// # Errors
/// Cancellation.
///
/// # Panics
/// When `filters` are not valid.
pub fn count_queries(
    distance: &SignedDistance,
    settings: &BandSettings,
    filters: &FilterSettings,
    run: &RunSettings,
) -> Result<FilterStatistics, Cancelled> {
    let Plan { filter, boxes, statistics } = Plan::new(distance, settings, filters);
    let count = |block| {
        run.check()?;
        let mut counts = FilterStatistics::default();
        let Verdict::Kept { triangle, .. } = filter.bounding_box(block, &mut counts) else {
            return Ok(counts);
        };
        let nodes = |width: i32| (width as u64).pow(3);
        if filters.octree == Switch::Off {
            counts.node_queries += nodes(block.width);
            return Ok(counts);
        }
        let mut node_queries = 0;
        filter.octree(block, triangle, MIN_BLOCK_WIDTH, &mut counts, &mut |block, verdict| {
            if matches!(verdict, Verdict::Kept { .. }) {
                node_queries += nodes(block.width);
            }
        });
        counts.node_queries += node_queries;
        Ok(counts)
    };
    run.install(|| {
        boxes.into_par_iter().map(count).try_reduce(FilterStatistics::default, |mut a, b| {
            a += b;
            Ok(a)
        })
    })
    .map(|mut counts| {
        counts += statistics;
        counts
    })
}
