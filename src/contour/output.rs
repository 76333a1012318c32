//! The polygons around all crossed edges, cut into triangles and collected to a mesh.

use super::cells::{Cells, split as cut};
use super::edge_polygon::{EdgePolygon, for_polygons, on_axis};
use super::face_vertex::FaceVertices;
use super::feature::Asker;
use super::order::VertexRun;
use super::polygonize::{Cut, CutMethod, EDGE_VERTEX, Fit, polygonize};
use super::rounds::LeafMesh;
use super::{ContourError, ContourStatistics, TooManyVertices};
use crate::band::LeafId;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, PhaseGuard};
use rayon::prelude::*;

/// The triangles around the crossed edges that start in one leaf.
#[derive(Debug, Default)]
struct LeafOutput {
    /// Vertex numbers; from the number of cell and face vertices on, they count the leaf's edge vertices.
    triangles: Vec<[u32; 3]>,
    /// By triangle the lower node of the edge that it lies around.
    nodes: Vec<u16>,
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
    let nodes = outputs.iter().flat_map(|output| output.nodes.iter().copied()).collect();
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
    let mesh =
        LeafMesh { mesh: TriMesh { vertices, triangles }, ranges, nodes, added, runs, gone: Vec::new() };
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
    let mut output = LeafOutput {
        triangles: Vec::with_capacity(2 * count),
        nodes: Vec::with_capacity(2 * count),
        sizes: Vec::with_capacity(count),
        ..LeafOutput::default()
    };
    let grid = &cells.grid;
    let is_open = cells.crossings.numbers.is_open();
    for_polygons(
        cells,
        faces,
        vertices,
        leaf,
        |EdgePolygon { polygon, envelope, fit, piece, node, number, along }| {
            let first = output.triangles.len();
            if is_open && polygon.corners().iter().any(|corner| corner.position[0].is_nan()) {
                output.sizes.push(0);
                return;
            }
            let cut = polygonize(&polygon, &envelope, &fit, method, &mut output.triangles);
            let hub = || grid.between_walls(node, on_axis(along.0, grid.clamp(along.1)));
            if let Some(surface) = cells.surface
                && !fit.sides.is_empty()
            {
                let corners = polygon.corners();
                let position = |v| corners.iter().find(|c| c.vertex == v).map_or_else(hub, |c| c.position);
                let mut ask = Asker { surface, origin: fit.point, voxel: grid.voxel(), piece };
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
                output.edge_vertices.push(hub());
            }
            output.sizes.push((output.triangles.len() - first) as u8);
            output.nodes.resize(output.triangles.len(), number);
            output.quads += 1;
        },
    );
    output
}

/// Polygons with a place that is farther from the surface than this, in voxels, are looked at again.
const FAR: f64 = 0.025;

/// Whether a point is far from the surface. What the features of the polygon say is asked first; the surface
/// itself has the last word.
fn is_far_at(p: [f64; 3], fit: &Fit<'_>, ask: &mut Asker) -> bool {
    fit.sides.distance(p) > FAR * ask.voxel && {
        let local = std::array::from_fn(|i| (p[i] - ask.origin[i]) / ask.voxel);
        ask.at(local).0.abs() > FAR
    }
}

/// Whether the middle of a triangle or of one of its sides is far from the surface.
fn is_far(
    triangles: &[[u32; 3]],
    position: impl Fn(u32) -> [f64; 3],
    fit: &Fit<'_>,
    ask: &mut Asker,
) -> bool {
    triangles.iter().any(|t| {
        let [a, b, c] = t.map(&position);
        let middle = |p: [f64; 3], q: [f64; 3]| std::array::from_fn(|i| 0.5 * (p[i] + q[i]));
        let centre = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        [centre, middle(a, b), middle(b, c), middle(c, a)].into_iter().any(|p| is_far_at(p, fit, ask))
    })
}
