//! Dual contouring without intersections (\[LW11\] section VI, extended).
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
//! `tests` prove the promise on random lattices with the exact audit of [`verify`](crate::verify), thousands of them
//! when `EXOCARP_HEAVY=1` is set; docs/contouring.md has the argument, and which test stands for which step.
//!
//! Where the surface can be asked for more than its crossings (a [`Surface`]), vertices are placed on its creases
//! and corners, also outside of their cells, and the mesh can be refined to a tolerance. Nothing of the promise
//! depends on what the surface answers.
//!
//! The way, a file for each step:
//!
//! | file | what |
//! |---|---|
//! | `grid` | the lattice rounded to the output's precision, before any decision |
//! | `cell`, `sheets` | the cube, and its 256 masks: pairs on faces, sheets, caps and their walls |
//! | `numbering` | active cells and their vertices, numbered by ranks in bit masks |
//! | `cells`, `leaf_crossings`, `leaf_vertices` | all cells, leaf by leaf, with the crossings of their edges (`beside`: what of them is a neighbour's) |
//! | `smooth` | the vertices of cells that see one smooth side, several at a time |
//! | `qef`, `region`, `vertex`, `vertex_set` | the vertex of any other sheet within its cell and its walls |
//! | `surface`, `planes`, `feature`, `features` | the surface's creases and corners: what a cell sees of them, where they are, remembered |
//! | `face_vertex` | vertices on faces where a connection would get in another sheet's way |
//! | `leaf_cells`, `edge_polygon` | the cells and the polygon around each crossed edge |
//! | `envelope`, `polygonize` | convex/concave analysis, and the triangles around an edge |
//! | `output`, `slots` | all polygons, collected to a mesh (`pieces`: what of it is moved) |
//! | `order` | the finished mesh leaf by leaf, and the part that a slab owns |
//! | `patch`, `editor`, `rounds` | changes of the finished mesh: the exact test, which to try, leaf by leaf |
//! | `recover`, `refine` | vertices to places outside of their cells; the mesh to a tolerance |
//! | `polygon_edges`, `cut_times` | the test that this analysis replaces, and the time of both |
//!
//! Why it holds: inside a cell lie the cones from its vertices over the triangles that crossed edges span with
//! the points where connections pass the cell's faces. On a face these triangles do not overlap, walls
//! separate the cones of different sheets, and a disc of good triangles stays in its edge's tetrahedra.

mod optimize;
mod mesh;
mod polygon;
mod vertex;
mod feature;
mod cell;
mod rounded_lattice;
mod statistics;
mod implicit_surface;

pub use crate::contour::optimize::STRAY;
pub use crate::contour::polygon::{CutMethod, CutTimes, cut_times};
pub use implicit_surface::{Creases, Surface};
pub use rounded_lattice::Precision;
pub use statistics::ContourStatistics;

use crate::band::SignField;
use crate::contour::cell::CellNumbers;
use crate::contour::optimize::{AT_CUT, LeafMesh, RECOVERY_STAGES, TOLERANCE_STAGES, Wish, recover, refine};
use crate::contour::polygon::{Triangulation, triangulate};
use crate::contour::vertex::{Cells, Placements, face_vertices};
use crate::edge::Crossings;
use crate::lattice::{LEAF_DIM, Lattice, Slab};
use crate::mesh::TriMesh;
use crate::run::{Cancelled, Phase, RunSettings};
use rounded_lattice::Grid;
use std::ops::Range;

/// Settings of [`contour`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourSettings {
    /// The coordinates of the result.
    pub precision: Precision,
    /// How the triangles around an edge are chosen.
    pub cut: CutMethod,
    /// Refine the mesh until it is within this many voxels of the surface; `None` leaves it as the lattice gives it.
    pub tolerance: Option<f64>,
    /// The part of the lattice that is counted.
    pub slab: Slab,
    /// The largest index, in size, of all nodes, where `signs` are not all; `None` if they are.
    pub reach: Option<u32>,
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

/// The surface between the inside and the outside nodes of `signs`, through `crossings`. With `surface`, its creases
/// and corners are asked for.
///
/// Vertices and triangles come leaf by leaf: of a leaf, cell vertices (by cell, sheet), face vertices, edge vertices,
/// then those that splits added; triangles in the order of their grid edges, then those that splits added. The
/// result is the same for every number of threads.
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
    surface: Option<&dyn Surface>,
    settings: &ContourSettings,
    run: &RunSettings,
) -> Result<(TriMesh, ContourStatistics), ContourError> {
    let contour = contour_slab(signs, crossings, lattice, surface, settings, run)?;
    let SlabContour { mesh, statistics, .. } = run.install(|| contour.into_ordered());
    Ok((mesh, statistics))
}

/// The contour of a slab before its vertices and triangles are in order. That takes as much memory again, for which what
/// the contour was made of can be dropped first.
#[derive(Debug)]
pub struct UnorderedContour {
    mesh: LeafMesh,
    /// The leaves that the slab owns.
    owned: Range<usize>,
    statistics: ContourStatistics,
}

impl UnorderedContour {
    /// In the order of [`contour`], on the current rayon pool.
    pub fn into_ordered(self) -> SlabContour {
        let UnorderedContour { mesh, owned, mut statistics } = self;
        let mesh = mesh.into_ordered();
        let (vertices, triangles) = mesh.of_leaves(owned);
        statistics.vertices = vertices.len() as u64;
        statistics.triangles = triangles.len() as u64;
        SlabContour { mesh: mesh.mesh, vertices, triangles, firsts: mesh.triangles, statistics }
    }
}

/// The contour of a slab and of what is computed around it.
#[derive(Debug)]
pub struct SlabContour {
    /// The contour of all that is computed. It has a border where that ends.
    pub mesh: TriMesh,
    /// The vertices that the slab owns.
    pub vertices: Range<usize>,
    /// The triangles that the slab owns. Some have vertices that its neighbours own.
    pub triangles: Range<usize>,
    /// By leaf of the signs the number of its first triangle, and the number of all at the end. No triangle reaches farther
    /// than [`STRAY`] voxels beyond its leaf.
    pub firsts: Vec<usize>,
    /// Counts of what it owns.
    pub statistics: ContourStatistics,
}

/// The same as [`contour`] for the part of the lattice that `settings.slab` names.
///
/// Vertices and triangles of the slabs of a lattice, one slab after the other, are those of the whole: what a slab owns is
/// the same in both. For that, `signs` must reach [`halo`] nodes beyond the slab.
///
/// # Errors
/// As [`contour`].
///
/// # Panics
/// As [`contour`].
pub fn contour_slab(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    surface: Option<&dyn Surface>,
    settings: &ContourSettings,
    run: &RunSettings,
) -> Result<UnorderedContour, ContourError> {
    assert_eq!(crossings.samples.len(), crossings.numbers.len(), "one sample for each crossing");
    let reach = settings.reach.unwrap_or_else(|| reach(signs, crossings));
    let grid = Grid::new(lattice, settings.precision, reach)?;
    run.install(|| {
        let numbers = CellNumbers::new(signs, run)?;
        let phase = run.phase(Phase::Contour, steps(&numbers, crossings));
        let (cells, placed) = Cells::place(signs, crossings, grid, settings.slab, &numbers, surface, &phase)?;
        let Placements { mut vertices, mut wishes, mut statistics } = placed;
        let mut faces = face_vertices(&cells, &vertices, run)?;
        vertices.append(&mut faces.positions);
        let Triangulation { mut mesh, far, statistics: polygons, .. } =
            triangulate(&cells, &faces, vertices, settings.cut, &phase)?;
        statistics += polygons;
        if let Some(surface) = surface {
            for (leaf, far) in far {
                let wishes = &mut wishes[leaf.0 as usize];
                wishes.extend(far.into_iter().map(|vertex| Wish { vertex, place: None }));
                // A vertex with a place comes before the same one without.
                wishes.sort_by_key(|wish| (wish.vertex, wish.place.is_none()));
                wishes.dedup_by_key(|wish| wish.vertex);
            }
            let recovered = recover(&cells, surface, &wishes, &mut mesh, run)?;
            statistics.recovered = recovered.moved;
            statistics.refused = recovered.refused;
            statistics.merged = recovered.merged;
            statistics.flipped = recovered.flipped;
            statistics.refined = recovered.split;
            statistics.given_up = recovered.given_up;
            if let Some(tolerance) = settings.tolerance {
                let refined = refine(&cells, surface, tolerance, &mut mesh, run)?;
                statistics.recovered += refined.moved;
                statistics.refined += refined.split;
                statistics.beyond_tolerance = Some(refined.beyond);
            }
        }
        // Leaves are sorted along x first.
        let first = signs.leaves().take_while(|&leaf| !cells.owns(leaf)).count();
        let owned = signs.leaves().skip(first).take_while(|&leaf| cells.owns(leaf)).count();
        Ok(UnorderedContour { mesh, owned: first..first + owned, statistics })
    })
}

/// How many nodes beyond a slab must be known, so that what it owns is as in a run over everything, for these settings.
///
/// Where the signs are cut off, the contour has a border, and each stage carries the difference further. With the
/// lower bit of a leaf's x as the first in its colour (see `rounds`), a leaf in the first half of a stage's rounds depends on
/// leaves beside it as they were before the stage; one in the second half on what the first half made of those. That is
/// two leaves for each stage. Those at the cut are not worked on, and the vertices of triangles at a plane lie up to two
/// leaves beyond it.
pub fn halo(settings: &ContourSettings) -> i32 {
    let stages = RECOVERY_STAGES.len() + settings.tolerance.map_or(0, |_| TOLERANCE_STAGES);
    LEAF_DIM * (AT_CUT + 2 * stages as i32 + 2)
}

/// The same as [`contour`] without a surface to ask, and with the number of triangles around each crossed edge, in the
/// order of the edges' numbers, which is that of the triangles. Where crossings are missing, so are the triangles of all edges
/// of a cell with such an edge; vertices that no triangle has are left out.
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
    assert_eq!(crossings.samples.len(), crossings.numbers.len(), "one sample for each crossing");
    let grid = Grid::new(lattice, precision, reach(signs, crossings))?;
    run.install(|| {
        let numbers = CellNumbers::new(signs, run)?;
        let phase = run.phase(Phase::Contour, steps(&numbers, crossings));
        let (cells, Placements { mut vertices, .. }) =
            Cells::place(signs, crossings, grid, Slab::WHOLE, &numbers, None, &phase)?;
        let mut faces = face_vertices(&cells, &vertices, run)?;
        vertices.append(&mut faces.positions);
        let Triangulation { mesh, sizes, .. } =
            triangulate(&cells, &faces, vertices, CutMethod::default(), &phase)?;
        let mut mesh = mesh.into_ordered().mesh;
        if crossings.numbers.is_open() {
            mesh.drop_unreferenced_vertices(0);
        }
        Ok((mesh, sizes))
    })
}

/// The leaves that are gone through for vertices and for triangles.
fn steps(numbers: &CellNumbers, crossings: &Crossings) -> u64 {
    (numbers.leaves().count() + crossings.numbers.leaves().len()) as u64
}

/// The largest index, in size, of a corner of an active cell.
fn reach(signs: &SignField, crossings: &Crossings) -> u32 {
    let crossed = signs.leaves().filter(|&leaf| !crossings.numbers.range(leaf).is_empty());
    let sizes = crossed.flat_map(|leaf| signs.origin(leaf).0.map(i32::unsigned_abs));
    // A leaf has 8 nodes, and cells reach one node further.
    sizes.max().unwrap_or(0).saturating_add(9)
}

#[cfg(test)]
mod tests;
