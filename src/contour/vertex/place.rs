//! The first steps of every contour: cells numbered, and a vertex for each sheet and each marked
//! face.

use super::cells::{CellCase, Cells};
use super::context::CellContext;
use super::face_vertex::{FaceVertices, face_vertices};
use super::leaf_vertices::LeafVertices;
use super::relocation::Relocation;
use crate::band::{LeafId, SignField};
use crate::contour::cell::CellNumbers;
use crate::contour::error::ContourError;
use crate::contour::feature::{CurvatureBound, FeatureMap, VertexSet};
use crate::contour::implicit_surface::ImplicitSurface;
use crate::contour::mesh::split_slices;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::contour::settings::ContourSettings;
use crate::contour::statistics::ContourStatistics;
use crate::edge::Crossings;
use crate::lattice::Lattice;
use crate::run::{Cancelled, Phase, PhaseGuard, RunSettings, SHARE};
use rayon::prelude::*;

/// One in so many vertices has room beside those of the cells.
const SPARE: usize = 64;

/// The cells and their vertices, before there are triangles.
pub struct PlacedVertices<'a> {
    /// The cells.
    pub cells: Cells<'a>,
    /// The numbers of the face vertices.
    pub faces: FaceVertices,
    /// The rounded positions of cell vertices, then of face vertices.
    pub vertices: Vec<[f64; 3]>,
    /// The vertices of each leaf that belong elsewhere.
    pub relocations: Vec<Vec<Relocation>>,
    /// Counts of cells and of cell vertices by kind.
    pub statistics: ContourStatistics,
}

/// Numbers the cells, places all vertices, and hands both to `finish` on the run's pool.
///
/// The phase that `finish` gets is advanced by one for each leaf with active cells. It expects one
/// more for each leaf with crossings.
///
/// # Errors
/// When the run is cancelled, there are too many vertices, the lattice is too far from the origin
/// for the precision, or `finish` fails.
///
/// # Panics
/// When `crossings` does not belong to `signs`.
pub fn with_vertices<R: Send>(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    surface: Option<&dyn ImplicitSurface>,
    settings: &ContourSettings,
    run: &RunSettings,
    finish: impl FnOnce(PlacedVertices<'_>, &PhaseGuard<'_>) -> Result<R, ContourError> + Send,
) -> Result<R, ContourError> {
    assert_eq!(crossings.samples.len(), crossings.numbers.len(), "one sample for each crossing");
    let extent = settings.extent.unwrap_or_else(|| extent(signs, crossings));
    let rounded = RoundedLattice::new(lattice, settings.precision, extent)?;
    run.install(|| {
        let numbers = CellNumbers::new(signs, run)?;
        let leaves = numbers.leaves().count() + crossings.numbers.leaves().len();
        let phase = run.phase(Phase::Contour, leaves as u64);
        let slab = settings.slab;
        let context = CellContext { signs, crossings, lattice: rounded, slab, numbers: &numbers, surface };
        let (cells, mut vertices, relocations, statistics) = place_cell_vertices(context, &phase)?;
        let mut faces = face_vertices(&cells, &vertices, run)?;
        vertices.append(&mut faces.positions);
        finish(PlacedVertices { cells, faces, vertices, relocations, statistics }, &phase)
    })
}

/// Returns the largest index, in size, of a corner of an active cell.
fn extent(signs: &SignField, crossings: &Crossings) -> u32 {
    let crossed = signs.leaves().filter(|&leaf| !crossings.numbers.range(leaf).is_empty());
    let sizes = crossed.flat_map(|leaf| signs.origin(leaf).0.map(i32::unsigned_abs));
    // A leaf has 8 nodes, and cells reach one node further.
    sizes.max().unwrap_or(0).saturating_add(9)
}

/// The cells, the positions of their vertices, relocations by leaf, and counts.
type CellVertices<'a> = (Cells<'a>, Vec<[f64; 3]>, Vec<Vec<Relocation>>, ContourStatistics);

/// Finds the cases of all active cells, and the positions of their vertices.
fn place_cell_vertices<'a>(
    context: CellContext<'a>,
    phase: &PhaseGuard<'_>,
) -> Result<CellVertices<'a>, Cancelled> {
    let CellContext { signs, numbers, surface, .. } = context;
    let mut cases: Vec<CellCase> = bytemuck::zeroed_vec(numbers.len());
    // Face and edge vertices come after these, and the whole need not move for those few. Room that
    // is not used is not touched.
    let count = numbers.vertices() as usize;
    let mut vertices = vec![[0.0; 3]; count + count / SPARE];
    vertices.truncate(count);
    let leaves: Vec<LeafId> = numbers.leaves().collect();
    let case_slices = split_slices(&mut cases, leaves.iter().map(|&leaf| numbers.range(leaf).len()));
    let vertex_counts = leaves.iter().map(|&leaf| numbers.vertex_range(leaf).len());
    let vertex_slices = split_slices(&mut vertices, vertex_counts);
    let placed: Vec<LeafVertices> = leaves
        .par_iter()
        .zip(case_slices)
        .zip(vertex_slices)
        .with_min_len(16)
        .with_max_len(SHARE)
        .map(|((&leaf, cases), vertices)| {
            phase.advance(1)?;
            Ok(LeafVertices::solve(&context, leaf, cases, vertices))
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut statistics = ContourStatistics::default();
    let mut maybe_ambiguous = vec![false; signs.len()];
    let mut relocations = vec![Vec::new(); signs.len()];
    let mut features = Vec::with_capacity(placed.iter().map(|own| own.features.len()).sum());
    let mut jumps = Vec::new();
    for (own, &leaf) in placed.into_iter().zip(&leaves) {
        maybe_ambiguous[leaf.0 as usize] = own.maybe_ambiguous;
        relocations[leaf.0 as usize] = own.relocations;
        features.extend(own.features);
        jumps.extend(own.jumps);
        if context.owns(leaf) {
            statistics.cells += numbers.range(leaf).len() as u64;
            statistics.several_sheets += u64::from(own.several_sheets);
            statistics.clamped += u64::from(own.clamped);
        }
    }
    let jumps = VertexSet::new(jumps.into_iter(), vertices.len());
    let features = FeatureMap::new(
        features,
        vertices.len(),
        surface.map_or(CurvatureBound::UNKNOWN, CurvatureBound::of),
    );
    Ok((Cells::new(context, cases, maybe_ambiguous, features, jumps), vertices, relocations, statistics))
}
