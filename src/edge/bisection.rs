//! Plain bisection: the straightforward way that the hybrid solver replaces (\[LW11\] section V),
//! kept to measure what the closed forms save (Table V).

use super::hybrid::{End, GridEdge, MIN_INTERVAL, Root, Solver};
use super::statistics::EdgeStatistics;

/// Halves the edge until a middle has abs(phi) up to `tolerance` voxels. Entry n of
/// `by_subdivision` counts the edges that are solved by n halvings.
pub(super) fn solve(
    solver: &Solver<'_>,
    edge: &GridEdge,
    tolerance: f64,
    statistics: &mut EdgeStatistics,
) -> Root {
    statistics.intersected += 1;
    let [inside, outside] = edge.triangles;
    let mut low = End { t: 0.0, sample: solver.node(edge, edge.inside, inside, statistics) };
    let mut high = End { t: 1.0, sample: solver.node(edge, edge.outside, outside, statistics) };
    // A node on the surface is the root, as for the hybrid method.
    if let Some(end) = [low, high].into_iter().find(|end| solver.is_root(end)) {
        statistics.by_subdivision[0] += 1;
        return solver.finish(edge, end);
    }
    if solver.phi(&low) >= 0.0 || solver.phi(&high) < 0.0 {
        return solver.jump(edge, 0.5, statistics);
    }
    for subdivisions in 1.. {
        let middle = solver.end(edge, 0.5 * (low.t + high.t), low.sample.triangle, statistics);
        if solver.phi(&middle).abs() <= tolerance * solver.voxel {
            match statistics.by_subdivision.get_mut(subdivisions) {
                Some(count) => *count += 1,
                None => statistics.bisected += 1,
            }
            return solver.finish(edge, middle);
        }
        solver.replace(&mut low, &mut high, middle);
        if high.t - low.t < MIN_INTERVAL {
            break;
        }
    }
    solver.collapsed(edge, low, high, statistics)
}
