//! The mesh of all polygons: each is split into triangles, and these are collected by leaf.

use super::edge_polygon::{EdgePolygon, for_polygons, on_axis};
use super::triangulate::{Fit, Split, triangulate_polygon};
use crate::band::LeafId;
use crate::contour::error::ContourError;
use crate::contour::feature::SurfaceProbe;
use crate::contour::mesh::{AXIS_STRIDE, LeafMesh, TriangleBuffer, TriangleSlots, VertexRun, split_slices};
use crate::contour::settings::DiagonalTest;
use crate::contour::statistics::ContourStatistics;
use crate::contour::vertex::{Cells, FaceVertices, is_missing};
use crate::lattice::LatticeError;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, PhaseGuard, SHARE};
use glam::DVec3;
use rayon::prelude::*;

/// The results for the polygons around the crossed edges that start in one leaf, besides the
/// triangles in their slots.
#[derive(Debug, Default)]
struct LeafOutput {
    /// The number of triangles.
    count: usize,
    /// All triangles, where they are more than the slots. A box, since few leaves have that and
    /// each has an output.
    overflow: Option<Box<TriangleBuffer>>,
    edge_vertices: Vec<[f64; 3]>,
    /// Feature vertices of polygons that are far from the surface.
    far: Vec<u32>,
    /// The number of polygons.
    quads: u32,
}

/// The mesh, with facts of its polygons.
#[derive(Debug)]
pub struct Triangulation {
    /// The mesh.
    pub mesh: LeafMesh,
    /// The feature vertices of polygons that are far from the surface, by leaf, of the leaves that
    /// have some.
    pub far: Vec<(LeafId, Vec<u32>)>,
    /// The number of triangles around each crossed edge.
    pub sizes: Vec<u8>,
    /// Counts of polygons and of their vertices.
    pub statistics: ContourStatistics,
}

/// Makes the mesh over the cell and face vertices `vertices`, to which edge vertices are added.
///
/// # Errors
/// When there are more than 2^32 - 1 vertices, or the run is cancelled.
pub fn triangulate(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    mut vertices: Vec<[f64; 3]>,
    test: DiagonalTest,
    phase: &PhaseGuard<'_>,
) -> Result<Triangulation, ContourError> {
    let leaves: Vec<LeafId> = cells.context.crossings.numbers.leaves().collect();
    let edges = |leaf: LeafId| cells.context.crossings.numbers.range(leaf).len();
    let mut sizes = vec![0; leaves.iter().map(|&leaf| edges(leaf)).sum()];
    // Nearly all edges have two triangles.
    let slots = || leaves.iter().map(|&leaf| 2 * edges(leaf));
    let mut triangles = TriangleBuffer::with_slots(2 * sizes.len());
    let (corner_slots, edge_slots) = triangles.split(slots());
    let size_slots = split_slices(&mut sizes, leaves.iter().map(|&leaf| edges(leaf)));
    let slices = corner_slots.into_par_iter().zip(edge_slots).zip(size_slots);
    let mut outputs: Vec<LeafOutput> = leaves
        .par_iter()
        .zip(slices)
        .with_min_len(16)
        .with_max_len(SHARE)
        .map(|(&leaf, ((corners, edges), sizes))| {
            phase.advance(1)?;
            Ok(in_leaf(cells, faces, &vertices, test, leaf, TriangleSlots::new(corners, edges), sizes))
        })
        .collect::<Result<_, Cancelled>>()?;

    let edge_vertices: usize = outputs.iter().map(|o| o.edge_vertices.len()).sum();
    // The largest number stands for no vertex elsewhere.
    if (vertices.len() + edge_vertices) as u64 >= u64::from(u32::MAX) {
        return Err(LatticeError::TooManyVertices.into());
    }
    let shared = vertices.len() as u32;
    vertices.reserve_exact(edge_vertices);
    let counts: Vec<usize> = outputs.iter().map(|output| output.count).collect();
    let starts = triangles.close_up(slots(), &counts);
    let all = || cells.context.signs.leaves();
    let cell_runs =
        all().map(|leaf| VertexRun { leaf, numbers: as_u32(cells.context.numbers.vertex_range(leaf)) });
    let face_runs = all().map(|leaf| VertexRun { leaf, numbers: faces.range(leaf) });
    let mut runs: Vec<VertexRun> = cell_runs.chain(face_runs).filter(|run| !run.numbers.is_empty()).collect();
    let mut far = Vec::new();
    for ((output, &leaf), &start) in outputs.iter_mut().zip(&leaves).zip(&starts) {
        if let Some(own) = output.overflow.take() {
            triangles.put(start, &own);
        }
        if !output.edge_vertices.is_empty() {
            let first = vertices.len() as u32;
            for vertex in triangles.vertices[start..start + output.count].as_flattened_mut() {
                *vertex += if *vertex < shared { 0 } else { first - shared };
            }
            vertices.extend_from_slice(&output.edge_vertices);
            runs.push(VertexRun { leaf, numbers: first..vertices.len() as u32 });
        }
        if !output.far.is_empty() {
            far.push((leaf, std::mem::take(&mut output.far)));
        }
    }
    let owned = || outputs.iter().zip(&leaves).filter(|(_, leaf)| cells.context.owns(**leaf));
    let quads: u64 = owned().map(|(output, _)| u64::from(output.quads)).sum();
    let split: u64 = owned().map(|(output, _)| output.edge_vertices.len() as u64).sum();
    let of_leaf = |leaf| faces.range(leaf).len() as u64;
    let face_vertices = all().filter(|&leaf| cells.context.owns(leaf)).map(of_leaf).sum();
    let statistics = ContourStatistics {
        quads,
        diagonal: quads - split,
        split,
        face_vertices,
        ..ContourStatistics::default()
    };
    let TriangleBuffer { vertices: triangles, edges } = triangles;
    let count = cells.context.signs.len();
    let mut firsts = Vec::with_capacity(count + 1);
    for (leaf, &start) in leaves.iter().zip(&starts) {
        // For the leaves before that have none, too.
        firsts.resize(leaf.0 as usize + 1, start);
    }
    firsts.resize(count + 1, triangles.len());
    let (changed, added) = (vec![Vec::new(); count], vec![Vec::new(); count]);
    let mesh = TriMesh { vertices, triangles };
    let mesh = LeafMesh { mesh, firsts, edges, changed, added, runs, removed: Vec::new() };
    Ok(Triangulation { mesh, far, sizes, statistics })
}

/// Returns a range of numbers that are known to fit.
fn as_u32(range: std::ops::Range<usize>) -> std::ops::Range<u32> {
    range.start as u32..range.end as u32
}

/// Splits the polygons around the crossed edges that start in one leaf.
fn in_leaf(
    cells: &Cells<'_>,
    faces: &FaceVertices,
    vertices: &[[f64; 3]],
    test: DiagonalTest,
    leaf: LeafId,
    mut slots: TriangleSlots<'_>,
    sizes: &mut [u8],
) -> LeafOutput {
    let mut output = LeafOutput::default();
    let mut triangles = Vec::new();
    let mut sizes = sizes.iter_mut();
    let lattice = &cells.context.lattice;
    let is_partial = cells.context.crossings.numbers.is_partial();
    for_polygons(
        cells,
        faces,
        vertices,
        leaf,
        |EdgePolygon { polygon, envelope, fit, triangle, node, number, along, is_jump }| {
            let size = sizes.next();
            if is_partial && polygon.corners().iter().any(|corner| is_missing(corner.position)) {
                return;
            }
            triangles.clear();
            // The leaf's edge vertices are numbered on from the cell and face vertices for now.
            let next = (vertices.len() + output.edge_vertices.len()) as u32;
            let split = triangulate_polygon(polygon, &envelope, &fit, test, next, &mut triangles);
            let edge_vertex =
                || lattice.between_walls(node, on_axis(along.0, lattice.clamp_to_edge(along.1)));
            if let Some(surface) = cells.context.surface
                && !is_jump
                && !fit.crease_planes.is_empty()
            {
                let corners = polygon.corners();
                let position =
                    |v| corners.iter().find(|c| c.vertex == v).map_or_else(edge_vertex, |c| c.position);
                let mut probe = SurfaceProbe { surface, origin: fit.point, voxel: lattice.voxel(), triangle };
                let far = is_far(&triangles, position, &fit, &mut probe);
                output.far.extend(corners.iter().filter_map(|corner| {
                    let is_feature = cells.features.get(corner.vertex).is_some();
                    let is_far = far && is_feature || is_far_at(corner.position, &fit, &mut probe);
                    (is_far && !cells.jumps.contains(corner.vertex)).then_some(corner.vertex)
                }));
            }
            if split == Split::Fan {
                output.edge_vertices.push(edge_vertex());
            }
            slots.extend(&triangles, number + AXIS_STRIDE * along.0 as u16);
            if let Some(size) = size {
                *size = triangles.len() as u8;
            }
            output.quads += 1;
        },
    );
    let (count, overflow) = slots.finish();
    (output.count, output.overflow) = (count, overflow.map(Box::new));
    output
}

/// The distance from the surface, in voxels, beyond which a polygon is looked at again.
const FAR: f64 = 0.025;

/// Whether a point is far from the surface.
///
/// The crease planes of the polygon are asked first. The surface itself has the last word.
fn is_far_at(p: [f64; 3], fit: &Fit<'_>, probe: &mut SurfaceProbe<'_>) -> bool {
    fit.crease_planes.distance(p) > FAR * probe.voxel && {
        let local = (DVec3::from(p) - probe.origin) / probe.voxel;
        probe.sample(local).0.abs() > FAR
    }
}

/// Whether the middle of a triangle or of one of its edges is far from the surface.
fn is_far(
    triangles: &[[u32; 3]],
    position: impl Fn(u32) -> [f64; 3],
    fit: &Fit<'_>,
    probe: &mut SurfaceProbe<'_>,
) -> bool {
    triangles.iter().any(|t| {
        let [a, b, c] = t.map(|v| DVec3::from(position(v)));
        let points = [(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        points.into_iter().any(|p| is_far_at(p.to_array(), fit, probe))
    })
}
