//! Topology of OUTPUT: the defects of its edges, vertices and triangles.

use super::report::TopologyReport;
use super::welded::Welded;
use crate::geom::triangle::TriangleSide;
use crate::mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

/// Angle in degrees below which a triangle is a sliver: its normal has lost about two digits.
const SLIVER: f64 = 1.0;

/// Counts the defects of a welded mesh. Runs on the current rayon pool.
pub(super) fn topology(welded: &Welded) -> TopologyReport {
    let mesh = &welded.mesh;
    let mut report = TopologyReport {
        vertices: used_vertices(welded),
        triangles: mesh.triangles.len() + welded.collapsed.len(),
        welded_vertices: welded.report.welded_vertices,
        unreferenced_vertices: welded.report.unreferenced_vertices,
        degenerate_triangles: welded.collapsed.len() + welded.flat.len(),
        first_degenerate: welded
            .collapsed
            .first()
            .copied()
            .into_iter()
            .chain(welded.flat.first().map(|&t| welded.in_file(t)))
            .min(),
        components: welded.topology.components(),
        ..TopologyReport::default()
    };
    count_edges(welded, &mut report);
    count_fans(welded, &mut report);
    measure_angles(welded, &mut report);
    count_duplicates(welded, &mut report);
    report.euler = report.vertices as i64 - report.edges as i64 + mesh.triangles.len() as i64;
    let is_surface = report.border_edges
        + report.non_manifold_edges
        + report.misoriented_edges
        + report.non_manifold_vertices
        == 0;
    // Each component of a closed oriented surface has Euler number 2 - 2 genus.
    report.genus = is_surface.then_some(report.components as i64 - report.euler / 2);
    report
}

/// Counts the vertices that a triangle uses.
fn used_vertices(welded: &Welded) -> usize {
    let vertices = 0..welded.mesh.vertices.len() as u32;
    vertices.into_par_iter().filter(|&v| !welded.topology.around_vertex(v).is_empty()).count()
}

/// Returns the undirected edges of a mesh, each once, by the first triangle and side.
pub(super) fn edges(welded: &Welded) -> impl ParallelIterator<Item = (u32, TriangleSide)> + '_ {
    (0..welded.mesh.triangles.len() as u32).into_par_iter().flat_map_iter(move |t| {
        let is_first =
            move |&side: &TriangleSide| welded.topology.around_edge(t, side).all(|other| other >= (t, side));
        TriangleSide::ALL.into_iter().filter(is_first).map(move |side| (t, side))
    })
}

/// Returns the ends of a directed edge.
pub(super) fn ends(mesh: &TriMesh, t: u32, side: TriangleSide) -> [u32; 2] {
    let triangle = mesh.triangles[t as usize];
    [triangle[side.index()], triangle[side.next().index()]]
}

/// Counts edges and their defects.
fn count_edges(welded: &Welded, report: &mut TopologyReport) {
    let mesh = &welded.mesh;
    report.edges = edges(welded).count();
    let is_bad = |&(t, side): &(u32, TriangleSide)| {
        let mut ring = welded.topology.around_edge(t, side).skip(1);
        match (ring.next(), ring.next()) {
            (Some((u, other)), None) => ends(mesh, t, side) == ends(mesh, u, other),
            _ => true,
        }
    };
    let bad: Vec<(u32, TriangleSide)> = edges(welded).filter(is_bad).collect();
    for (t, side) in bad {
        let at = ends(mesh, t, side).map(|v| mesh.vertices[v as usize]);
        let (count, first) = match welded.topology.around_edge(t, side).count() {
            1 => (&mut report.border_edges, &mut report.first_border),
            2 => (&mut report.misoriented_edges, &mut report.first_misoriented),
            _ => (&mut report.non_manifold_edges, &mut report.first_non_manifold_edge),
        };
        *count += 1;
        first.get_or_insert(at);
    }
}

/// Counts vertices with several fans.
fn count_fans(welded: &Welded, report: &mut TopologyReport) {
    let vertices = 0..welded.mesh.vertices.len() as u32;
    let has_several = |fan: &mut Fan, v| (!fan.is_whole(welded, v)).then_some(v);
    let bad: Vec<u32> = vertices.into_par_iter().map_init(Fan::default, has_several).flatten_iter().collect();
    report.non_manifold_vertices = bad.len();
    report.first_non_manifold_vertex = bad.first().map(|&v| welded.mesh.vertices[v as usize]);
}

/// Scratch space of a walk around a vertex.
#[derive(Default)]
struct Fan {
    /// Per triangle of the vertex, whether the walk has reached it.
    reached: Vec<bool>,
    /// Triangles that were reached and whose neighbours were not looked at.
    waiting: Vec<u32>,
}

impl Fan {
    /// Whether all triangles at `vertex` can be reached from each other through edges at it.
    fn is_whole(&mut self, welded: &Welded, vertex: u32) -> bool {
        let around = welded.topology.around_vertex(vertex);
        let Some(&first) = around.first() else { return true };
        self.reached.clear();
        self.reached.resize(around.len(), false);
        self.reached[0] = true;
        self.waiting.push(first);
        let mut count = 0;
        while let Some(t) = self.waiting.pop() {
            count += 1;
            for side in TriangleSide::ALL {
                if !ends(&welded.mesh, t, side).contains(&vertex) {
                    continue;
                }
                for (other, _) in welded.topology.around_edge(t, side) {
                    let slot = around.binary_search(&other).expect("a triangle at an edge is at its ends");
                    if !std::mem::replace(&mut self.reached[slot], true) {
                        self.waiting.push(other);
                    }
                }
            }
        }
        count == around.len()
    }
}

/// Finds slivers and the smallest angle.
fn measure_angles(welded: &Welded, report: &mut TopologyReport) {
    let with_area = |&t: &u32| welded.flat.binary_search(&t).is_err();
    let angles = (0..welded.mesh.triangles.len() as u32)
        .into_par_iter()
        .filter(with_area)
        .map(|t| (smallest_angle(welded.mesh.corners(t as usize)), t));
    let (slivers, smallest) = angles.map(|(angle, t)| (usize::from(angle < SLIVER), (angle, t))).reduce(
        || (0, (f64::INFINITY, u32::MAX)),
        |(m, a), (n, b)| (m + n, if b.0 < a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a }),
    );
    report.slivers = slivers;
    if smallest.1 != u32::MAX {
        report.smallest_angle = Some(smallest.0);
        report.smallest_angle_triangle = Some(welded.in_file(smallest.1));
    }
}

/// Returns the smallest angle of a triangle, in degrees.
fn smallest_angle(corners: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(DVec3::from);
    // Far from pi the arc tangent keeps its digits near 0, where the arc cosine loses them.
    let angle = |p: DVec3, q: DVec3| p.cross(q).length().atan2(p.dot(q));
    angle(b - a, c - a).min(angle(c - b, a - b)).min(angle(a - c, b - c)).to_degrees()
}

/// Counts triangles with the corners of an earlier one.
fn count_duplicates(welded: &Welded, report: &mut TopologyReport) {
    // Duplicates have an edge in common, with more than two triangles or two that are the same.
    let sorted = |t: u32| {
        let mut vertices = welded.mesh.triangles[t as usize];
        vertices.sort_unstable();
        vertices
    };
    let repeats = |&t: &u32| {
        let mut ring = welded.topology.around_edge(t, TriangleSide::ALL[0]).skip(1);
        ring.any(|(other, _)| other < t && sorted(other) == sorted(t))
    };
    let numbers = 0..welded.mesh.triangles.len() as u32;
    let duplicates: Vec<u32> = numbers.into_par_iter().filter(repeats).collect();
    report.duplicate_triangles = duplicates.len();
    report.first_duplicate = duplicates.first().map(|&t| welded.in_file(t));
}
