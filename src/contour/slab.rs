//! The row of steps: the contour of a slab of the lattice, or of all of it.

use super::error::ContourError;
use super::implicit_surface::ImplicitSurface;
use super::mesh::LeafMesh;
use super::optimize::{BORDER_LEAVES, RECOVERY_PASSES, TOLERANCE_PASSES, recover, refine};
use super::polygon::{Triangulation, triangulate};
use super::settings::ContourSettings;
use super::statistics::ContourStatistics;
use super::vertex::{Cells, PlacedVertices, Relocation, with_vertices};
use crate::band::{LeafId, SignField};
use crate::edge::Crossings;
use crate::lattice::{LEAF_DIM, Lattice};
use crate::mesh::TriMesh;
use crate::quantity::Precision;
use crate::run::{Cancelled, RunSettings};
use std::ops::Range;

/// Contours the surface between the inside and the outside nodes of `signs`, through `crossings`.
///
/// With `surface`, features are placed outside of their cells as well, and the tolerance is kept.
///
/// Vertices and triangles come leaf by leaf. The vertices of a leaf are its cell vertices (by cell,
/// then by sheet), face vertices, edge vertices, then vertices that splits added. The triangles of
/// a leaf come in the order of their grid edges, then those that splits added. The result is the
/// same for every number of threads.
///
/// # Errors
/// When the run is cancelled, the result is too large, or the lattice reaches too far from the
/// origin for the precision.
///
/// # Panics
/// When `crossings` does not belong to `signs`.
pub fn contour(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    surface: Option<&dyn ImplicitSurface>,
    settings: &ContourSettings,
    run: &RunSettings,
) -> Result<(TriMesh, ContourStatistics), ContourError> {
    let contour = contour_slab(signs, crossings, lattice, surface, settings, run)?;
    let SlabContour { mesh, statistics, .. } = run.install(|| contour.into_ordered());
    Ok((mesh, statistics))
}

/// The contour of a slab, before vertices and triangles are ordered.
///
/// Ordering takes as much memory again. The inputs of the contour can be dropped before.
#[derive(Debug)]
pub struct UnorderedContour {
    mesh: LeafMesh,
    /// The leaves that the slab owns.
    owned: Range<usize>,
    statistics: ContourStatistics,
}

impl UnorderedContour {
    /// Orders vertices and triangles as [`contour`] does, on the current rayon pool.
    pub fn into_ordered(self) -> SlabContour {
        let UnorderedContour { mesh, owned, mut statistics } = self;
        let mesh = mesh.into_ordered();
        let (vertices, triangles) = mesh.of_leaves(owned);
        statistics.vertices = vertices.len() as u64;
        statistics.triangles = triangles.len() as u64;
        SlabContour { mesh: mesh.mesh, vertices, triangles, firsts: mesh.triangles, statistics }
    }
}

/// The contour of a slab and of the margin that is computed around it.
#[derive(Debug)]
pub struct SlabContour {
    /// The contour of slab and margin. The mesh has a border where the margin ends.
    pub mesh: TriMesh,
    /// The vertices that the slab owns.
    pub vertices: Range<usize>,
    /// The triangles that the slab owns. Some have vertices that the next slabs own.
    pub triangles: Range<usize>,
    /// The number of the first triangle of each leaf of the signs, and the number of all at the
    /// end.
    ///
    /// No triangle reaches farther than [`MAX_TRIANGLE_REACH`](super::MAX_TRIANGLE_REACH) voxels
    /// beyond its leaf.
    pub firsts: Vec<usize>,
    /// Counts of what the slab owns.
    pub statistics: ContourStatistics,
}

/// Contours the part of the lattice that `settings.slab` names.
///
/// Vertices and triangles of all slabs of a lattice, one slab after the other, are those of the
/// whole contour: what a slab owns is the same in both. For that, `signs` must reach [`halo`] nodes
/// beyond the slab.
///
/// # Errors
/// When the run is cancelled, the result is too large, or the lattice reaches too far from the
/// origin for the precision.
///
/// # Panics
/// When `crossings` does not belong to `signs`.
pub fn contour_slab(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    surface: Option<&dyn ImplicitSurface>,
    settings: &ContourSettings,
    run: &RunSettings,
) -> Result<UnorderedContour, ContourError> {
    with_vertices(signs, crossings, lattice, surface, settings, run, |placed, phase| {
        let PlacedVertices { cells, faces, vertices, mut relocations, mut statistics } = placed;
        let Triangulation { mut mesh, far, statistics: polygons, .. } =
            triangulate(&cells, &faces, vertices, settings.diagonal_test, phase)?;
        statistics += polygons;
        if let Some(surface) = surface {
            add_far_vertices(&mut relocations, far);
            let tolerance = settings.tolerance;
            optimize(&cells, surface, &relocations, tolerance, &mut mesh, &mut statistics, run)?;
        }
        // Leaves are sorted along x first.
        let first = signs.leaves().take_while(|&leaf| !cells.context.owns(leaf)).count();
        let owned = signs.leaves().skip(first).take_while(|&leaf| cells.context.owns(leaf)).count();
        Ok(UnorderedContour { mesh, owned: first..first + owned, statistics })
    })
}

/// Adds the feature vertices of polygons that are far from the surface to the relocations of their
/// leaves.
fn add_far_vertices(relocations: &mut [Vec<Relocation>], far: Vec<(LeafId, Vec<u32>)>) {
    for (leaf, far) in far {
        let relocations = &mut relocations[leaf.0 as usize];
        relocations.extend(far.into_iter().map(|vertex| Relocation { vertex, target: None }));
        // A vertex with a target comes before the same one without.
        relocations.sort_by_key(|relocation| (relocation.vertex, relocation.target.is_none()));
        relocations.dedup_by_key(|relocation| relocation.vertex);
    }
}

/// Recovers features outside of their cells, and refines the mesh to a tolerance in voxels if there
/// is one.
fn optimize(
    cells: &Cells<'_>,
    surface: &dyn ImplicitSurface,
    relocations: &[Vec<Relocation>],
    tolerance: Option<f64>,
    mesh: &mut LeafMesh,
    statistics: &mut ContourStatistics,
    run: &RunSettings,
) -> Result<(), Cancelled> {
    let recovered = recover(cells, surface, relocations, mesh, run)?;
    statistics.recovered = recovered.moved;
    statistics.refused = recovered.refused;
    statistics.merged = recovered.merged;
    statistics.flipped = recovered.flipped;
    statistics.refined = recovered.split;
    statistics.given_up = recovered.given_up;
    if let Some(tolerance) = tolerance {
        let refined = refine(cells, surface, tolerance, mesh, run)?;
        statistics.recovered += refined.moved;
        statistics.refined += refined.split;
        statistics.beyond_tolerance = Some(refined.beyond);
    }
    Ok(())
}

/// Returns the number of nodes beyond a slab that must be known, so that what the slab owns is as
/// in a run over everything.
///
/// Where the signs are cut off, the contour has a border, and each pass over the mesh carries the
/// difference further. The lower bit of a leaf's x is the first one of its colour (see
/// `optimize/schedule`). So a leaf in the first half of a pass depends on the leaves beside it as
/// they were before the pass, and a leaf in the second half on what the first half made of those.
/// That is two leaves for each pass. Leaves at the border are not worked on, and the vertices of
/// triangles at a plane lie up to two leaves beyond it.
pub fn halo(settings: &ContourSettings) -> i32 {
    let passes = RECOVERY_PASSES + settings.tolerance.map_or(0, |_| TOLERANCE_PASSES);
    LEAF_DIM * (BORDER_LEAVES + 2 * passes as i32 + 2)
}

/// Contours without a surface to sample, and returns the number of triangles around each crossed
/// edge as well.
///
/// These numbers come in the order of the edges, which is that of the triangles. Where crossings
/// are missing, the triangles of all edges of a cell with such an edge are missing, too. Vertices
/// without a triangle are left out.
///
/// # Errors
/// As [`contour`].
///
/// # Panics
/// As [`contour`].
pub(crate) fn contour_by_edge(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    precision: Precision,
    run: &RunSettings,
) -> Result<(TriMesh, Vec<u8>), ContourError> {
    let settings = ContourSettings { precision, ..ContourSettings::default() };
    with_vertices(signs, crossings, lattice, None, &settings, run, |placed, phase| {
        let PlacedVertices { cells, faces, vertices, .. } = placed;
        let Triangulation { mesh, sizes, .. } =
            triangulate(&cells, &faces, vertices, settings.diagonal_test, phase)?;
        let mut mesh = mesh.into_ordered().mesh;
        if crossings.numbers.is_partial() {
            mesh.drop_unreferenced_vertices(0);
        }
        Ok((mesh, sizes))
    })
}
