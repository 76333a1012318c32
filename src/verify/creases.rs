//! Creases of the true offset surface, and OUTPUT's edges along them.

use super::case::Case;
use super::input_edges::{Bend, BentEdge, bent_edges};
use super::report::CreaseReport;
use super::sampling::each;
use crate::run::Cancelled;
use glam::{DMat3, DVec3};

/// Maximum distance of an edge from a crease, in voxels. An edge that is off by more can be seen.
const WITHIN: f64 = 0.05;

/// Minimum cosine of the angle between a crease and an edge along it. Edges as long as a voxel with
/// both ends within 5% are within 6 degrees; others are shorter. Edges across are at 45 degrees or
/// more.
const ALONG: f64 = 0.96;

/// Number of samples per voxel of length: an edge is seldom shorter than half a voxel.
const SAMPLES_PER_VOXEL: f64 = 2.0;

/// Distances from the crease at which both sides are asked for the closest point, as shares of |D|.
///
/// The first finds the right facets. Each of the following is larger than the error that the one
/// before left. The last is so small that the error by curvature (its square) is below
/// [`Case::exact`].
const STEPS: [f64; 4] = [0.05, 0.01, 1e-3, 1e-5];

/// A point of a crease.
#[derive(Clone, Copy, Debug)]
struct CreasePoint {
    at: DVec3,
    /// Unit direction of the crease.
    tangent: DVec3,
    /// Length of crease that the point stands for, in model units.
    length: f64,
    has_edge: bool,
}

/// Measures the share of the creases that OUTPUT has.
pub(super) fn creases(case: &Case) -> Result<CreaseReport, Cancelled> {
    let within = WITHIN * case.voxel();
    let edges = sharp_edges(case);
    let samples = samples(&edges, case);
    let found = each(samples.len(), case.run, |i, guess| {
        let (edge, t, length) = samples[i];
        let mut point = trace(case, &edges[edge], t, length, guess)?;
        point.has_edge = has_edge(case, &point, within);
        Some(point)
    })?;
    let found: Vec<CreasePoint> = found.into_iter().flatten().collect();
    // Not `sum`, whose empty sum is -0.
    let length_of =
        |keep: fn(&CreasePoint) -> bool| found.iter().filter(|p| keep(p)).fold(0.0, |sum, p| sum + p.length);
    let (length, present) = (length_of(|_| true), length_of(|p| p.has_edge));
    Ok(CreaseReport {
        input_edges: edges.len(),
        length,
        present,
        share: (length > 0.0).then(|| present / length),
        within,
        first_absent: found.iter().find(|p| !p.has_edge).map(|p| p.at.to_array()),
    })
}

/// Returns the edges of INPUT that creases are traced from.
fn sharp_edges(case: &Case) -> Vec<BentEdge> {
    // At distance 0 the creases are the edges themselves, of both kinds.
    let (mesh, topology) = (case.distance.mesh(), case.distance.topology());
    let of = |bend| bent_edges(mesh, topology, case.input(), case.r, bend);
    let mut edges = of(Bend::Sharp);
    if case.r == 0.0 {
        edges.extend(of(Bend::Round));
    }
    edges.retain(|e| e.angle > case.settings.crease_angle.to_radians());
    edges
}

/// Returns edge number, parameter and length of each sample, evenly along each edge.
fn samples(edges: &[BentEdge], case: &Case) -> Vec<(usize, f64, f64)> {
    let total: f64 = edges.iter().map(BentEdge::length).sum();
    let spacing = (case.voxel() / SAMPLES_PER_VOXEL).max(total / case.settings.samples as f64);
    let of_edge = |(number, edge): (usize, &BentEdge)| {
        // Casts saturate; an edge has at least one sample.
        let count = (edge.length() / spacing).ceil().max(1.0) as usize;
        let length = edge.length() / count as f64;
        (0..count).map(move |i| (number, (i as f64 + 0.5) / count as f64, length))
    };
    edges.iter().enumerate().flat_map(of_edge).collect()
}

/// Finds the crease in the plane across the edge at parameter `t`; `None` if the offset has none
/// there.
///
/// The search begins where the offsets of the edge's two faces meet. Where one of these faces ends
/// before, the closest points on both sides name the faces that follow.
fn trace(case: &Case, edge: &BentEdge, t: f64, length: f64, guess: &mut u32) -> Option<CreasePoint> {
    let [n1, n2] = edge.normals;
    let along = (edge.ends[1] - edge.ends[0]).normalize_or_zero();
    let p = edge.at(t);
    if case.r == 0.0 {
        return Some(CreasePoint { at: p, tangent: along, length, has_edge: false });
    }
    let d = case.r.abs();
    let middle = (n1 + n2).normalize_or_zero();
    let mut q = p + case.r * middle / middle.dot(n1);
    let towards_first = -case.r.signum() * (n1 - n2).normalize_or_zero();
    let mut tangent = along;
    for step in STEPS.map(|s| s * d) {
        let mut plane = |side: DVec3| {
            let x = q + side;
            case.to_input(x, guess);
            let closest = case.input().triangle(*guess).closest(x).point;
            let gradient = (x - closest).normalize_or_zero();
            // Points whose distance is |D|, as seen from x.
            (gradient, d + gradient.dot(closest))
        };
        let (g1, at1) = plane(step * towards_first);
        let (g2, at2) = plane(-step * towards_first);
        tangent = g1.cross(g2);
        let sharpest = (0.5 * case.settings.crease_angle).to_radians().sin();
        if tangent.length() < sharpest {
            return None;
        }
        // Rows g1, g2, along.
        let rows = DMat3::from_cols(g1, g2, along).transpose();
        if rows.determinant().abs() < 1e-3 * sharpest {
            return None;
        }
        q = rows.inverse() * DVec3::new(at1, at2, along.dot(p));
    }
    let tangent = tangent.normalize();
    let is_exact = (case.to_input(q, guess) - d).abs() <= case.exact();
    let stretch = 1.0 / tangent.dot(along).abs().max(0.1);
    is_exact.then_some(CreasePoint { at: q, tangent, length: length * stretch, has_edge: false })
}

/// Whether OUTPUT has an edge along the crease at a point, at most `within` away.
fn has_edge(case: &Case, point: &CreasePoint, within: f64) -> bool {
    let mut found = false;
    case.tree.near(point.at, within, |t| {
        let corners = case.corners(t);
        found |= (0..3).any(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let direction = (b - a).normalize_or_zero();
            let nearest = a + direction * (point.at - a).dot(direction).clamp(0.0, (b - a).length());
            direction.dot(point.tangent).abs() >= ALONG && (nearest - point.at).length() <= within
        });
    });
    found
}
