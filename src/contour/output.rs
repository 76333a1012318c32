//! The polygons around all crossed edges, cut into triangles and collected to a mesh.

use super::cell::Edge;
use super::cells::{Cells, split as cut};
use super::envelope::Envelope;
use super::face_vertex::FaceVertices;
use super::feature::Asker;
use super::order::VertexRun;
use super::polygonize::{Cut, CutMethod, EDGE_VERTEX, Fit, Polygon, PolygonCorner, polygonize};
use super::rounds::LeafMesh;
use super::{ContourError, ContourStatistics, TooManyVertices};
use crate::band::{Axis, Ijk, LEAF_DIM, LeafId};
use crate::edge::EdgeId;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, PhaseGuard};
use rayon::prelude::*;

/// The triangles around the crossed edges that start in one leaf.
#[derive(Debug, Default)]
struct LeafOutput {
    /// Vertex numbers; from the number of cell and face vertices on, they count the leaf's edge vertices.
    triangles: Vec<[u32; 3]>,
    edge_vertices: Vec<[f64; 3]>,
    /// Feature vertices of polygons that are far from the surface.
    far: Vec<u32>,
    /// The number of triangles of each polygon.
    sizes: Vec<u8>,
    /// Polygons.
    quads: u64,
}

/// The mesh, and what is known of its parts.
#[derive(Debug)]
pub struct Triangulation {
    /// The mesh.
    pub mesh: LeafMesh,
    /// By leaf the feature vertices of polygons that are far from the surface.
    pub far: Vec<Vec<u32>>,
    /// The number of triangles around each crossed edge.
    pub sizes: Vec<u8>,
    /// Counts.
    pub statistics: ContourStatistics,
}

/// The mesh over the cell and face vertices `vertices`, to which edge vertices are added.
///
/// # Errors
/// More than 2^32 - 1 vertices, or cancellation.
pub fn triangulate(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    mut vertices: Vec<[f64; 3]>,
    method: CutMethod,
    phase: &PhaseGuard<'_>,
) -> Result<Triangulation, ContourError> {
    let leaves: Vec<LeafId> = cells.signs.leaves().collect();
    let mut outputs: Vec<LeafOutput> = leaves
        .par_iter()
        .with_min_len(16)
        .map(|&leaf| {
            phase.advance(1)?;
            Ok(in_leaf(cells, faces, &vertices, method, leaf))
        })
        .collect::<Result<_, Cancelled>>()?;

    let count: usize = outputs.iter().map(|o| o.triangles.len()).sum();
    let hubs: usize = outputs.iter().map(|o| o.edge_vertices.len()).sum();
    // The number that stands for an edge vertex must stay free.
    if (vertices.len() + hubs) as u64 >= u64::from(EDGE_VERTEX) {
        return Err(TooManyVertices.into());
    }
    let shared = vertices.len() as u32;
    vertices.reserve_exact(hubs);
    let mut firsts = Vec::with_capacity(outputs.len());
    let mut ranges = Vec::with_capacity(outputs.len() + 1);
    let mut next = 0;
    let cell_runs = leaves.iter().map(|&leaf| (leaf, as_u32(cells.numbers.vertex_range(leaf))));
    let face_runs = leaves.iter().map(|&leaf| (leaf, faces.range(leaf)));
    let mut runs: Vec<VertexRun> =
        cell_runs.chain(face_runs).map(|(leaf, numbers)| VertexRun { leaf, numbers }).collect();
    for (output, &leaf) in outputs.iter().zip(&leaves) {
        ranges.push(next);
        next += output.triangles.len();
        let first = vertices.len() as u32;
        firsts.push(first - shared);
        vertices.extend_from_slice(&output.edge_vertices);
        runs.push(VertexRun { leaf, numbers: first..vertices.len() as u32 });
    }
    runs.retain(|run| !run.numbers.is_empty());
    ranges.push(next);
    let far = outputs.iter_mut().map(|output| std::mem::take(&mut output.far)).collect();
    let owned = || outputs.iter().zip(&leaves).filter(|(_, leaf)| cells.owns(**leaf));
    let quads: u64 = owned().map(|(output, _)| output.quads).sum();
    let split: u64 = owned().map(|(output, _)| output.edge_vertices.len() as u64).sum();
    let face_vertices = owned().map(|(_, &leaf)| faces.range(leaf).len() as u64).sum();
    let sizes = outputs.iter().flat_map(|output| output.sizes.iter().copied()).collect();
    let mut triangles = vec![[0; 3]; count];
    let parts = cut(&mut triangles, outputs.iter().map(|o| o.triangles.len()));
    outputs.into_par_iter().zip(firsts).zip(parts).with_min_len(16).for_each(|((output, first), part)| {
        for (to, from) in part.iter_mut().zip(output.triangles) {
            *to = from.map(|v| if v < shared { v } else { v + first });
        }
    });
    let statistics = ContourStatistics {
        quads,
        diagonal: quads - split,
        split,
        face_vertices,
        ..ContourStatistics::default()
    };
    let added = vec![Vec::new(); leaves.len()];
    let mesh = LeafMesh { mesh: TriMesh { vertices, triangles }, ranges, added, runs, gone: Vec::new() };
    Ok(Triangulation { mesh, far, sizes, statistics })
}

/// A range of numbers, which fit.
fn as_u32(range: std::ops::Range<usize>) -> std::ops::Range<u32> {
    range.start as u32..range.end as u32
}

fn in_leaf(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    vertices: &[[f64; 3]],
    method: CutMethod,
    leaf: LeafId,
) -> LeafOutput {
    let count = cells.crossings.numbers.range(leaf).len();
    let mut output = LeafOutput { triangles: Vec::with_capacity(2 * count), ..LeafOutput::default() };
    let grid = &cells.grid;
    for_polygons(
        cells,
        faces,
        vertices,
        leaf,
        |EdgePolygon { polygon, envelope, fit, hint, node, along }| {
            let first = output.triangles.len();
            let cut = polygonize(&polygon, &envelope, &fit, method, &mut output.triangles);
            let hub = grid.between_walls(node, on_axis(along.0, grid.clamp(along.1)));
            if let Some(surface) = cells.surface
                && !fit.sides.is_empty()
            {
                let corners = polygon.corners();
                let position = |v| corners.iter().find(|c| c.vertex == v).map_or(hub, |c| c.position);
                let mut ask = Asker { surface, origin: fit.point, voxel: grid.voxel(), hint };
                let far = is_far(&output.triangles[first..], position, &fit, &mut ask);
                output.far.extend(corners.iter().filter_map(|corner| {
                    let is_feature = cells.features.get(corner.vertex).is_some();
                    (far && is_feature || is_far_at(corner.position, &fit, &mut ask)).then_some(corner.vertex)
                }));
            }
            if cut == Cut::Split {
                let vertex = (vertices.len() + output.edge_vertices.len()) as u32;
                for corner in output.triangles[first..].as_flattened_mut() {
                    if *corner == EDGE_VERTEX {
                        *corner = vertex;
                    }
                }
                output.edge_vertices.push(hub);
            }
            output.sizes.push((output.triangles.len() - first) as u8);
            output.quads += 1;
        },
    );
    output
}

/// Polygons with a place that is farther from the surface than this, in voxels, are looked at again.
const FAR: f64 = 0.025;

/// Whether a point is far from the surface. What the features of the polygon say is asked first; the surface
/// itself has the last word.
fn is_far_at(p: [f64; 3], fit: &Fit, ask: &mut Asker) -> bool {
    fit.sides.distance(p) > FAR * ask.voxel && {
        let local = std::array::from_fn(|i| (p[i] - ask.origin[i]) / ask.voxel);
        ask.at(local).0.abs() > FAR
    }
}

/// Whether the middle of a triangle or of one of its sides is far from the surface.
fn is_far(triangles: &[[u32; 3]], position: impl Fn(u32) -> [f64; 3], fit: &Fit, ask: &mut Asker) -> bool {
    triangles.iter().any(|t| {
        let [a, b, c] = t.map(&position);
        let middle = |p: [f64; 3], q: [f64; 3]| std::array::from_fn(|i| 0.5 * (p[i] + q[i]));
        let centre = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        [centre, middle(a, b), middle(b, c), middle(c, a)].into_iter().any(|p| is_far_at(p, fit, ask))
    })
}

/// The polygon around a crossed edge, and what decides how it is cut.
#[derive(Clone, Copy, Debug)]
pub struct EdgePolygon {
    /// The cell and face vertices around the edge.
    pub polygon: Polygon,
    /// The edge's envelope.
    pub envelope: Envelope,
    /// The surface at the crossing.
    pub fit: Fit,
    /// See [`Crossing::hint`](crate::edge::Crossing).
    hint: u32,
    /// The edge's lower node.
    node: Ijk,
    /// The crossing, in voxels from that node.
    along: (Axis, f64),
}

/// Hands the polygons around the crossed edges that start in `leaf` to `visit`, in the order of the edges.
#[inline]
pub fn for_polygons(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    vertices: &[[f64; 3]],
    leaf: LeafId,
    mut visit: impl FnMut(EdgePolygon),
) {
    let numbers = &cells.crossings.numbers;
    let grid = &cells.grid;
    let inside = cells.signs.inside(leaf);
    let origin = cells.signs.origin(leaf);
    for (id, (axis, number)) in numbers.range(leaf).map(EdgeId).zip(numbers.in_leaf(leaf)) {
        let local = Ijk::in_leaf(Ijk::default(), number);
        if axis != Axis::X && is_at_cut(cells, leaf, local) {
            continue;
        }
        let node = origin + local;
        let low_is_inside = inside[number >> 6] >> (number & 63) & 1 == 1;
        let ends = [grid.node(node), grid.node(node.next(axis))];
        let (outside, envelope) = if low_is_inside {
            (End::High, Envelope { above: ends[1], below: ends[0] })
        } else {
            (End::Low, Envelope { above: ends[0], below: ends[1] })
        };
        let polygon = polygon(cells, faces, vertices, leaf, local, axis, outside);
        let sample = cells.crossings.sample(id);
        let point = grid.ideal(node, on_axis(axis, sample.t));
        let sides = cells.features.sides(polygon.corners().iter().map(|c| c.vertex));
        let fit = Fit::new(point, sample.normal.map(f64::from), sides, grid.voxel());
        visit(EdgePolygon { polygon, envelope, fit, hint: sample.hint, node, along: (axis, sample.t) });
    }
}

/// Whether not all cells around the edges across x from node `local` of `leaf` are there, since the field is cut off.
fn is_at_cut(cells: &Cells<'_>, leaf: LeafId, local: Ijk) -> bool {
    const LAST: i32 = LEAF_DIM - 1;
    match local.0[0] {
        0 => cells.signs.is_cut(leaf, -1),
        LAST => cells.signs.is_cut(leaf, 1),
        _ => false,
    }
}

/// The offset `t` along `axis`.
fn on_axis(axis: Axis, t: f64) -> [f64; 3] {
    let mut along = [0.0; 3];
    along[axis as usize] = t;
    along
}

/// An end of a grid edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Low,
    High,
}

/// The cells around an edge along an axis as offsets (0 or -1) in the other two axes (u, v), counter-clockwise
/// seen from the upper end.
const AROUND: [[i32; 2]; 4] = [[0, 0], [-1, 0], [-1, -1], [0, -1]];

/// Between cell i and cell i + 1 around an edge: the lower one of the two, and whether the next one follows
/// along u (0) or v (1).
const BETWEEN: [(usize, usize); 4] = [(1, 0), (2, 1), (2, 0), (3, 1)];

/// The polygon around the edge from node `local` of `leaf` along `axis`, counter-clockwise seen from the
/// end that is outside.
#[inline]
fn polygon(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    vertices: &[[f64; 3]],
    leaf: LeafId,
    local: Ijk,
    axis: Axis,
    outside: End,
) -> Polygon {
    let (u, v) = axis.others();
    let around = AROUND.map(|[du, dv]| {
        let mut at = local.0;
        at[u as usize] += du;
        at[v as usize] += dv;
        let (leaf, cell) = cells.numbers.locate(cells.signs, leaf, at);
        (leaf, cell, Edge::new(axis, -du as u8, -dv as u8))
    });
    let corner = |vertex: u32| PolygonCorner { vertex, position: vertices[vertex as usize] };
    let cell_vertex = |i: usize| corner(cells.vertex(around[i].1, around[i].2));
    let face_vertex = |i: usize| {
        let (lower, along) = BETWEEN[i];
        let (leaf, cell, edge) = around[lower];
        faces.get(leaf, cell, cells.case(cell), [u, v][along], edge).map(corner)
    };
    let mut polygon = Polygon::default();
    for i in 0..4 {
        let (cell, face) = match outside {
            End::High => (i, i),
            // Backwards: 0, 3, 2, 1, with the face between cells i and i + 1 before cell i.
            End::Low => ((4 - i) % 4, 3 - i),
        };
        polygon.push(cell_vertex(cell));
        if let Some(corner) = face_vertex(face) {
            polygon.push(corner);
        }
    }
    polygon
}
