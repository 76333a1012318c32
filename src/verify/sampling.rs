//! Reproducible samples, and their statistics.

use super::report::{ReportedLength, Statistics};
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use rayon::prelude::*;

/// Number of samples that a task evaluates one after the other, each from the last one's result.
/// Fewer, and the first of a task, which starts from nothing, costs too much. More, and cancelling
/// takes longer.
const SAMPLES_PER_TASK: usize = 2048;

/// Source of random numbers that depend on the seed and their purpose alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct Random {
    seed: u64,
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Random { seed }
    }

    /// Returns number `k` for item `i`, uniform in [0, 1): splitmix64 (Steele et al. 2014).
    pub fn uniform(&self, i: usize, k: u64) -> f64 {
        let mix = |x: u64| {
            let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
            x ^ x >> 31
        };
        const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
        let key = mix(self.seed.wrapping_add(GOLDEN)) ^ mix((i as u64).wrapping_mul(GOLDEN) ^ (k << 56));
        (mix(key.wrapping_add(GOLDEN)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a point, uniform over the area of a triangle.
    pub fn on_triangle(&self, i: usize, [a, b, c]: [DVec3; 3]) -> DVec3 {
        let (mut u, mut v) = (self.uniform(i, 1), self.uniform(i, 2));
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        a + u * (b - a) + v * (c - a)
    }
}

/// A draw of items in proportion to their weights, one from each of equal parts of the total
/// weight. So the draw is uniform and even at once, and neighbours in the list are neighbours in
/// the draw.
#[derive(Debug)]
pub(super) struct Draw {
    /// Sums of the weights up to each item.
    sums: Vec<f64>,
}

impl Draw {
    /// Prepares a draw of items with these weights.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut sum = 0.0;
        let sums = weights.into_iter().map(|w| {
            sum += w;
            sum
        });
        Draw { sums: sums.collect() }
    }

    /// Returns the total weight.
    pub fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// Returns the number of samples that can be drawn: `wanted`, or none without weight.
    pub fn available(&self, wanted: usize) -> usize {
        if self.total() > 0.0 { wanted } else { 0 }
    }

    /// Returns the item of sample `i` of `count`.
    pub fn item(&self, i: usize, count: usize, random: Random) -> usize {
        let at = (i as f64 + random.uniform(i, 0)) / count as f64 * self.total();
        // Rounding may reach the total.
        self.sums.partition_point(|&sum| sum <= at).min(self.sums.len() - 1)
    }
}

/// Evaluates samples 0 to `count`, in parallel, and returns the results in order. Each sample gets
/// the guess that the one before it left; the guess must not change a result.
///
/// # Errors
/// [`Cancelled`].
pub(super) fn each<T: Send, G: Default>(
    count: usize,
    run: &RunSettings,
    evaluate: impl Fn(usize, &mut G) -> T + Sync,
) -> Result<Vec<T>, Cancelled> {
    let tasks: Vec<Vec<T>> = (0..count.div_ceil(SAMPLES_PER_TASK))
        .into_par_iter()
        .map(|task| {
            run.check()?;
            let mut guess = G::default();
            let range = task * SAMPLES_PER_TASK..((task + 1) * SAMPLES_PER_TASK).min(count);
            Ok(range.map(|i| evaluate(i, &mut guess)).collect())
        })
        .collect::<Result<_, Cancelled>>()?;
    Ok(tasks.into_iter().flatten().collect())
}

/// The units of a report, in model units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    pub diagonal: f64,
    pub voxel: Option<f64>,
}

impl Scale {
    /// Returns a length in model units in the three units of a report.
    pub fn length(&self, units: f64) -> ReportedLength {
        let percent_of_diagonal = 100.0 * units / self.diagonal;
        ReportedLength { units, percent_of_diagonal, voxels: self.voxel.map(|h| units / h) }
    }

    /// Returns the statistics of errors. `at` gives the position of sample i.
    pub fn statistics(&self, mut errors: Vec<f64>, at: impl Fn(usize) -> DVec3) -> Statistics {
        let samples = errors.len();
        let Some((worst, max)) = largest(&errors) else { return Statistics::default() };
        // One after the other, so that the sum does not depend on the threads.
        let (sum, squares) = errors.iter().fold((0.0, 0.0), |(s, q), e| (s + e, q + e * e));
        let rank = ((0.999 * samples as f64).ceil() as usize).clamp(1, samples) - 1;
        let p999 = *errors.select_nth_unstable_by(rank, f64::total_cmp).1;
        Statistics {
            samples,
            mean: self.length(sum / samples as f64),
            rms: self.length((squares / samples as f64).sqrt()),
            p999: self.length(p999),
            max: self.length(max),
            max_at: Some(at(worst).to_array()),
        }
    }
}

/// Returns the index of the first largest error, and the error.
pub(super) fn largest(errors: &[f64]) -> Option<(usize, f64)> {
    let max = errors.iter().copied().reduce(f64::max)?;
    errors.iter().position(|&e| e == max).map(|i| (i, max))
}

/// Returns the largest error of several statistics, with its position.
pub(super) fn worst(all: &[&Statistics]) -> (ReportedLength, Option<[f64; 3]>) {
    let largest = all.iter().copied().reduce(|a, b| if b.max.units > a.max.units { b } else { a });
    largest.map_or((ReportedLength::default(), None), |s| (s.max, s.max_at))
}
