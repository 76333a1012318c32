//! Distance of OUTPUT from the true offset surface.

use super::case::{Case, weight};
use super::report::{DistanceReport, Histogram, Statistics};
use super::sampling::{Draw, each, worst};
use super::topology::{edges, ends};
use crate::geom::triangle::TriangleSide;
use crate::run::Cancelled;
use glam::DVec3;
use rayon::prelude::*;

/// Power of ten, as a share of the diagonal, at which the histogram begins: where f32 coordinates
/// end.
const FIRST_DECADE: i32 = -9;

/// Number of powers of ten in the histogram, up to the whole diagonal.
const DECADES: u32 = 9;

/// Number of bins per power of ten: narrow enough for a chart.
const PER_DECADE: u32 = 8;

/// Measures the error of distances over samples of OUTPUT.
pub(super) fn distance_error(case: &Case) -> Result<DistanceReport, Cancelled> {
    let (surface, histogram, wrong_side) = over_surface(case)?;
    let vertices = at_vertices(case)?;
    let edge_midpoints = at_midpoints(case)?;
    let (max, max_at) = worst(&[&surface, &vertices, &edge_midpoints]);
    Ok(DistanceReport { surface, vertices, edge_midpoints, max, max_at, wrong_side, histogram })
}

/// Maximum number of vertices, and of midpoints, in multiples of the area-uniform samples. A mesh
/// with fewer has all of them looked at; more would take most of the time without finding anything
/// new.
const POINTS_PER_SAMPLE: usize = 4;

/// Chooses items evenly where there are more than are looked at.
fn chosen<T: Copy>(case: &Case, items: Vec<T>) -> Vec<T> {
    let most = case.settings.samples.saturating_mul(POINTS_PER_SAMPLE);
    if items.len() <= most {
        return items;
    }
    let index = |i: usize| (i as f64 * (items.len() as f64 / most as f64)) as usize;
    (0..most).map(|i| items[index(i)]).collect()
}

/// Error of one sample, in model units, and its side.
#[derive(Clone, Copy)]
struct Sampled {
    error: f64,
    wrong_side: bool,
}

/// Samples the area.
fn over_surface(case: &Case) -> Result<(Statistics, Histogram, Option<f64>), Cancelled> {
    let order = case.tree.order();
    let draw = Draw::new(order.iter().map(|&t| weight(case.corners(t))));
    let count = draw.available(case.settings.samples);
    let at = |i| {
        let t = order[draw.item(i, count, case.random)];
        case.random.on_triangle(i, case.corners(t))
    };
    let closed = case.distance.topology().defects().is_closed();
    let samples = each(count, case.run, |i, guess| {
        let p = at(i);
        let dis = case.to_input(p, guess);
        // Near INPUT the sign is that of rounding.
        let sided = closed && case.r != 0.0 && dis > 0.5 * case.r.abs();
        let wrong_side = sided && (case.distance.from_triangle(p, *guess).distance < 0.0) != (case.r < 0.0);
        Sampled { error: error(case, dis), wrong_side }
    })?;
    let wrong = samples.iter().filter(|s| s.wrong_side).count();
    let errors: Vec<f64> = samples.iter().map(|s| s.error).collect();
    let histogram = histogram(&errors, case.scale.diagonal);
    let share = closed.then(|| wrong as f64 / count.max(1) as f64);
    Ok((statistics(case, errors, at), histogram, share))
}

/// Samples the vertices.
fn at_vertices(case: &Case) -> Result<Statistics, Cancelled> {
    let mesh = &case.output.mesh;
    let mut seen = vec![false; mesh.vertices.len()];
    let corners = case.tree.order().iter().flat_map(|&t| mesh.triangles[t as usize]);
    let order: Vec<u32> = corners.filter(|&v| !std::mem::replace(&mut seen[v as usize], true)).collect();
    let order = chosen(case, order);
    let at = |i: usize| DVec3::from(mesh.vertices[order[i] as usize]);
    let errors = each(order.len(), case.run, |i, guess| error(case, case.to_input(at(i), guess)))?;
    Ok(statistics(case, errors, at))
}

/// Samples the midpoints of edges.
fn at_midpoints(case: &Case) -> Result<Statistics, Cancelled> {
    let mesh = &case.output.mesh;
    let first_sides: Vec<(u32, TriangleSide)> = edges(case.output).collect();
    let begin: Vec<usize> = (0..=mesh.triangles.len() as u32)
        .into_par_iter()
        .map(|t| first_sides.partition_point(|&(u, _)| u < t))
        .collect();
    let order: Vec<(u32, TriangleSide)> = case
        .tree
        .order()
        .iter()
        .flat_map(|&t| &first_sides[begin[t as usize]..begin[t as usize + 1]])
        .copied()
        .collect();
    let order = chosen(case, order);
    let at = |i: usize| {
        let (t, side) = order[i];
        let [a, b] = ends(mesh, t, side).map(|v| DVec3::from(mesh.vertices[v as usize]));
        0.5 * (a + b)
    };
    let errors = each(order.len(), case.run, |i, guess| error(case, case.to_input(at(i), guess)))?;
    Ok(statistics(case, errors, at))
}

/// Returns the error at a point with unsigned distance `dis` from INPUT; NaN where there is nothing
/// to judge.
fn error(case: &Case, dis: f64) -> f64 {
    let d = case.r.abs();
    if !case.is_shell() || dis >= 0.75 * d {
        (dis - d).abs()
    } else if dis <= 0.25 * d {
        dis
    } else {
        // Between the sheets: a wall.
        f64::NAN
    }
}

/// Returns the statistics of the errors that are judged.
fn statistics(case: &Case, errors: Vec<f64>, at: impl Fn(usize) -> DVec3) -> Statistics {
    let judged: Vec<usize> = (0..errors.len()).filter(|&i| !errors[i].is_nan()).collect();
    let values = judged.iter().map(|&i| errors[i]).collect();
    case.scale.statistics(values, |i| at(judged[i]))
}

/// Counts errors by their size as a share of the diagonal.
fn histogram(errors: &[f64], diagonal: f64) -> Histogram {
    let mut counts = vec![0; (DECADES * PER_DECADE) as usize];
    let last = counts.len() - 1;
    for error in errors.iter().filter(|e| !e.is_nan()) {
        let bin = ((error / diagonal).log10() - f64::from(FIRST_DECADE)) * f64::from(PER_DECADE);
        // Casts saturate: an error of 0 goes to the first bin.
        counts[(bin.max(0.0) as usize).min(last)] += 1;
    }
    Histogram { first: FIRST_DECADE, per_decade: PER_DECADE, counts }
}
