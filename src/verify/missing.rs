//! Distance of the true offset surface from OUTPUT: what is missing.
//!
//! Candidates are p + D n over faces, and p + D m over the arcs and caps of normals m about edges
//! and vertices. Candidates whose distance from INPUT is |D| are points of the true offset surface.
//! The others lie in folds that an offset does not have.

use super::case::{Case, weight};
use super::input_edges::{Bend, BentEdge, bent_edges};
use super::report::{MissingReport, Statistics};
use super::sampling::{Draw, each, worst};
use crate::run::Cancelled;
use glam::DVec3;

/// Divisor of the number of samples, for edges: arcs are small beside the faces.
const EDGE_PART: usize = 2;

/// Divisor of the number of samples, for vertices: caps are small beside the faces.
const VERTEX_PART: usize = 4;

/// A point of the true offset surface, with its distance from OUTPUT in model units.
#[derive(Clone, Copy)]
struct Found {
    at: DVec3,
    distance: f64,
}

/// Measures distances of the true offset surface from OUTPUT.
pub(super) fn missing(case: &Case) -> Result<MissingReport, Cancelled> {
    // Built here and not by the first sample, so that all threads take part.
    case.output_ssvh();
    let limit = case.settings.tolerance.or(case.settings.voxel.map(|h| 0.5 * h));
    let mut beyond = 0;
    let mut statistics = |found: Vec<Option<Found>>| -> Statistics {
        let found: Vec<Found> = found.into_iter().flatten().collect();
        beyond += found.iter().filter(|f| limit.is_some_and(|limit| f.distance > limit)).count();
        let distances = found.iter().map(|f| f.distance).collect();
        case.scale.statistics(distances, |i| found[i].at)
    };
    let faces = statistics(of_faces(case)?);
    let edges = statistics(of_edges(case)?);
    let vertices = statistics(of_vertices(case)?);
    let all = [&faces, &edges, &vertices];
    let points = all.iter().map(|s| s.samples).sum::<usize>();
    let share = limit.map(|_| beyond as f64 / points.max(1) as f64);
    let (max, max_at) = worst(&all);
    Ok(MissingReport { faces, edges, vertices, max, max_at, limit, share })
}

/// A triangle of INPUT and one of OUTPUT, near the last sample.
type Guess = (u32, u32);

/// Returns the candidate `q` if it is on the true offset surface. `triangle` is at distance |D|
/// from it.
fn judge(case: &Case, q: DVec3, triangle: u32, (_, near): &mut Guess) -> Option<Found> {
    let mut closest = triangle;
    let distance = case.to_input(q, &mut closest);
    ((distance - case.r.abs()).abs() <= case.exact())
        .then(|| Found { at: q, distance: case.to_output(q, near) })
}

/// Samples the offsets of faces.
fn of_faces(case: &Case) -> Result<Vec<Option<Found>>, Cancelled> {
    let ssvh = case.input();
    let order = &case.input_order;
    let draw = Draw::new(order.iter().map(|&t| weight(ssvh.triangle(t).corners)));
    let count = draw.available(case.settings.samples);
    each(count, case.run, |i, guess| {
        let t = order[draw.item(i, count, case.random)];
        let triangle = ssvh.triangle(t);
        let p = case.random.on_triangle(i, triangle.corners);
        judge(case, p + case.r * triangle.normal, t, guess)
    })
}

/// Samples the arcs about edges.
fn of_edges(case: &Case) -> Result<Vec<Option<Found>>, Cancelled> {
    let edges = round_edges(case);
    let draw = Draw::new(edges.iter().map(|e| e.length() * e.angle));
    let count = draw.available(case.settings.samples / EDGE_PART);
    each(count, case.run, |i, guess| {
        let edge = &edges[draw.item(i, count, case.random)];
        let part = case.random.uniform(i, 2) * edge.angle;
        // The normal turned by a part of the angle towards the other one.
        let [n, other] = edge.normals;
        let sideways = (other - n * n.dot(other)).normalize_or_zero();
        let m = n * part.cos() + sideways * part.sin();
        judge(case, edge.at(case.random.uniform(i, 1)) + case.r * m, edge.triangle, guess)
    })
}

/// Samples the caps about vertices.
fn of_vertices(case: &Case) -> Result<Vec<Option<Found>>, Cancelled> {
    let (mesh, topology) = (case.distance.mesh(), case.distance.topology());
    // The weight of a vertex is the sum of the angles of its edges.
    let mut bend = vec![0.0; mesh.vertices.len()];
    for edge in round_edges(case) {
        edge.vertices.iter().for_each(|&v| bend[v as usize] += edge.angle);
    }
    let draw = Draw::new(bend);
    let count = draw.available(case.settings.samples / VERTEX_PART);
    each(count, case.run, |i, guess| {
        let v = draw.item(i, count, case.random);
        let around = topology.around_vertex(v as u32);
        // Exponential weights spread over all mixtures of the normals.
        let mix = around
            .iter()
            .zip(1..)
            .map(|(&t, k)| -(1.0 - case.random.uniform(i, k)).ln() * case.input().triangle(t).normal);
        let m = mix.sum::<DVec3>().normalize_or_zero();
        judge(case, DVec3::from(mesh.vertices[v]) + case.r * m, around[0], guess)
    })
}

/// Returns the edges of INPUT about which the true offset surface is round.
fn round_edges(case: &Case) -> Vec<BentEdge> {
    if case.r == 0.0 {
        return Vec::new();
    }
    let (mesh, topology) = (case.distance.mesh(), case.distance.topology());
    bent_edges(mesh, topology, case.input(), case.r, Bend::Round)
}
