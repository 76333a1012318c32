//! Dual contouring without intersections ([LW11] section VI, extended).
//!
//! Input is a sign for every node and a crossing for every grid edge with a sign change. Whatever they
//! are, the output is
//!
//! * closed and consistently oriented, counter-clockwise seen from outside,
//! * 2-manifold: two triangles at every edge, one fan at every vertex,
//! * free of intersecting, touching and degenerate triangles,
//!
//! exactly, for the coordinates as they are returned, which are those that a file of the chosen
//! [`Precision`] can hold. It is void when the mesh is moved, scaled or rounded further afterwards.
//! Creases and corners of the surface come out where the minimiser of the error function lies in its cell.
//!
//! The way, a file for each step:
//!
//! | file | what |
//! |---|---|
//! | `grid` | the lattice rounded to the output's precision, before any decision |
//! | `cell`, `sheets` | the cube, and its 256 masks: pairs on faces, sheets, caps and their walls |
//! | `numbering` | active cells and their vertices, numbered by ranks in bit masks |
//! | `qef`, `region`, `vertex` | the vertex of a sheet within its cell and its walls |
//! | `face_vertex` | vertices on faces where a connection would get in another sheet's way |
//! | `envelope`, `polygonize` | convex/concave analysis, and the triangles around an edge |
//!
//! Why it holds: inside a cell lie the cones from its vertices over the triangles that crossed edges span with
//! the points where connections pass the cell's faces. On a face these triangles do not overlap, walls
//! separate the cones of different sheets, and a disc of good triangles stays in its edge's tetrahedra.

mod cell;
mod envelope;
mod face_vertex;
mod grid;
mod numbering;
mod output;
mod polygonize;
mod qef;
mod region;
mod sheets;
mod statistics;
mod vertex;

pub use grid::Precision;
pub use statistics::ContourStatistics;

use crate::band::{Ijk, Lattice, LeafId, SignField};
use crate::edge::{Crossings, bits};
use crate::mesh::TriMesh;
use crate::run::{Cancelled, Phase, PhaseGuard, RunSettings};
use cell::Edge;
use grid::Grid;
use numbering::{CellId, CellNumbers, CornerSigns, constant_case, locate};
use rayon::prelude::*;
use sheets::{Case, CaseId, CaseTable};
use vertex::Placement;

/// Settings of [`contour`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContourSettings {
    /// The coordinates of the result.
    pub precision: Precision,
}

/// Why [`contour`] failed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContourError {
    /// The run was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The result has too many vertices.
    #[error(transparent)]
    TooManyVertices(#[from] TooManyVertices),
    /// The coordinates of the chosen precision are too coarse for the voxel size.
    #[error(
        "coordinates of size {far} are too coarse in {precision:?} for voxels of size {voxel}; \
         choose 64-bit coordinates, larger voxels, or move the model to the origin"
    )]
    TooFarFromOrigin {
        /// The largest coordinate, in model units.
        far: f64,
        /// The voxel size, in model units.
        voxel: f64,
        /// The precision that was asked for.
        precision: Precision,
    },
}

/// The mesh would have more than 2^32 - 1 vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the result has more than 4294967295 vertices; choose a larger voxel size")]
pub struct TooManyVertices;

/// The surface between the inside and the outside nodes of `signs`, through `crossings`.
///
/// Vertices come in the order cell vertices (by leaf, cell, sheet), face vertices, edge vertices; triangles
/// in the order of their grid edges. The result is the same for every number of threads.
///
/// # Errors
/// When the run is cancelled, the result is too large, or the lattice reaches too far from the origin for
/// the precision.
///
/// # Panics
/// When `crossings` does not belong to `signs`.
pub fn contour(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    settings: &ContourSettings,
    run: &RunSettings,
) -> Result<(TriMesh, ContourStatistics), ContourError> {
    assert_eq!(crossings.samples.len(), crossings.numbers.len(), "one sample for each crossing");
    let grid = Grid::new(lattice, settings.precision, reach(signs, crossings))?;
    let phase = run.phase(Phase::Contour, 2 * signs.len() as u64);
    run.install(|| {
        let numbers = CellNumbers::new(signs, run)?;
        let (cases, mut vertices, mut statistics) =
            place_vertices(signs, crossings, &grid, &numbers, &phase)?;
        let cells = Cells { signs, crossings, grid, numbers: &numbers, cases };
        let mut faces = face_vertex::face_vertices(&cells, &vertices, run)?;
        vertices.append(&mut faces.positions);
        statistics.face_vertices = vertices.len() as u64 - u64::from(numbers.vertices());
        let (mesh, polygons) = output::triangulate(&cells, &faces, vertices, &phase)?;
        statistics += polygons;
        statistics.vertices = mesh.vertices.len() as u64;
        statistics.triangles = mesh.triangles.len() as u64;
        Ok((mesh, statistics))
    })
}

/// The largest index, in size, of a corner of an active cell.
fn reach(signs: &SignField, crossings: &Crossings) -> u32 {
    let crossed = signs.leaves().filter(|&leaf| !crossings.numbers.range(leaf).is_empty());
    let sizes = crossed.flat_map(|leaf| signs.origin(leaf).0.map(i32::unsigned_abs));
    // A leaf has 8 nodes, and cells reach one node further.
    sizes.max().unwrap_or(0).saturating_add(9)
}

/// The active cells with everything that is known of them.
struct Cells<'a> {
    signs: &'a SignField,
    crossings: &'a Crossings,
    grid: Grid,
    numbers: &'a CellNumbers,
    cases: Vec<CellCase>,
}

/// The case of an active cell, and its vertices.
#[derive(Clone, Copy, Debug, Default)]
struct CellCase {
    /// The number of the vertex of sheet 0; the other sheets' follow.
    first_vertex: u32,
    case: CaseId,
}

impl Cells<'_> {
    #[inline]
    fn case(&self, cell: CellId) -> &'static Case {
        CaseTable::get().case(self.cases[cell.0 as usize].case)
    }

    /// The number of the vertex of the sheet of `cell` through the crossing of `edge`.
    #[inline]
    fn vertex(&self, cell: CellId, edge: Edge) -> u32 {
        let CellCase { first_vertex, case } = self.cases[cell.0 as usize];
        first_vertex + CaseTable::get().case(case).sheet_of(edge)
    }
}

/// The cases of all active cells, and the positions of their vertices.
#[allow(clippy::type_complexity)]
fn place_vertices(
    signs: &SignField,
    crossings: &Crossings,
    grid: &Grid,
    numbers: &CellNumbers,
    phase: &PhaseGuard<'_>,
) -> Result<(Vec<CellCase>, Vec<[f64; 3]>, ContourStatistics), ContourError> {
    let mut cases = vec![CellCase::default(); numbers.len()];
    let mut vertices = vec![[0.0; 3]; numbers.vertices() as usize];
    let leaves: Vec<LeafId> = signs.leaves().collect();
    let case_slices = split(&mut cases, leaves.iter().map(|&leaf| numbers.range(leaf).len()));
    let vertex_slices = split(&mut vertices, leaves.iter().map(|&leaf| numbers.vertex_range(leaf).len()));
    let statistics = leaves
        .par_iter()
        .zip(case_slices)
        .zip(vertex_slices)
        .with_min_len(16)
        .map(|((&leaf, cases), vertices)| {
            phase.advance(1)?;
            Ok(place_in_leaf(signs, crossings, grid, numbers, leaf, cases, vertices))
        })
        .try_reduce(ContourStatistics::default, |mut a, b| {
            a += b;
            Ok::<_, Cancelled>(a)
        })?;
    Ok((cases, vertices, statistics))
}

/// Fills in the cases and the vertices of the cells of one leaf.
fn place_in_leaf(
    signs: &SignField,
    crossings: &Crossings,
    grid: &Grid,
    numbers: &CellNumbers,
    leaf: LeafId,
    cases: &mut [CellCase],
    vertices: &mut [[f64; 3]],
) -> ContourStatistics {
    let mut statistics = ContourStatistics { cells: cases.len() as u64, ..Default::default() };
    let Some(corners) = CornerSigns::new(signs, leaf) else { return statistics };
    let table = CaseTable::get();
    let first_vertex = numbers.vertex_range(leaf).start as u32;
    let mut done = 0;
    for (cell, number) in cases.iter_mut().zip(bits(numbers.active(leaf))) {
        let id = constant_case(table, corners.mask(number));
        *cell = CellCase { first_vertex: first_vertex + done as u32, case: id };
        let case = table.case(id);
        statistics.several_sheets += u64::from(case.has_several_sheets());
        let local = Ijk::in_leaf(Ijk::default(), number);
        let crossing = |edge: Edge| {
            let (at, number) = locate(signs, leaf, (local + Ijk(edge.low().offset())).0);
            let id = crossings.numbers.get(at, edge.axis(), number).expect("the edge changes sign");
            crossings.sample(id)
        };
        for sheet in 0..case.sheets().len() {
            let (position, placement) =
                vertex::place(grid, signs.origin(leaf) + local, case, sheet, crossing);
            vertices[done] = position;
            done += 1;
            statistics.clamped += u64::from(placement == Placement::Clamped);
        }
    }
    statistics
}

/// Cuts a slice into consecutive parts of the given lengths.
fn split<T>(mut slice: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    lengths
        .map(|length| {
            let (part, rest) = std::mem::take(&mut slice).split_at_mut(length);
            slice = rest;
            part
        })
        .collect()
}

#[cfg(test)]
pub(crate) mod tests;
