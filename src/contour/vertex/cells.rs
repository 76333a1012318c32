//! The active cells: their cases and the vertices of their sheets.

use super::leaf_vertices::LeafVertices;
use crate::band::{LeafId, SignField};
use crate::contour::ContourStatistics;
use crate::contour::cell::{Case, CaseId, CaseTable, CellId, CellNumbers, Edge};
use crate::contour::feature::{Bend, Features, VertexSet};
use crate::contour::implicit_surface::Surface;
use crate::contour::optimize::Wish;
use crate::contour::rounded_lattice::Grid;
use crate::edge::Crossings;
use crate::lattice::Slab;
use crate::run::{Cancelled, PhaseGuard, SHARE};
use rayon::prelude::*;

/// One in so many vertices has room beside those of the cells.
const SPARE: usize = 64;

/// The active cells with everything that is known of them.
pub struct Cells<'a> {
    /// The signs of the nodes.
    pub signs: &'a SignField,
    /// The crossings of the edges.
    pub crossings: &'a Crossings,
    /// The rounded lattice.
    pub grid: Grid,
    /// The part of the lattice whose cells are counted.
    pub slab: Slab,
    /// The numbering of the cells.
    pub numbers: &'a CellNumbers,
    /// The surface, if there is one to ask.
    pub surface: Option<&'a dyn Surface>,
    /// The vertices on creases and corners.
    pub features: Features,
    /// The vertices of cells with a jump of the sign ([`Crossing::is_jump`](crate::edge::Crossing::is_jump)): the surface is
    /// elsewhere.
    pub jumps: VertexSet,
    cases: Vec<CellCase>,
    /// By leaf, whether any of its cells is crowded ([`CornerSigns::crowded`](crate::contour::cell::CornerSigns::crowded)).
    crowded: Vec<bool>,
}

/// The case of an active cell, and its vertices.
#[derive(Clone, Copy, Debug, Default, bytemuck::Zeroable)]
pub struct CellCase {
    /// The number of the vertex of sheet 0; the other sheets' follow.
    pub first_vertex: u32,
    /// How the contour runs through it.
    pub case: CaseId,
}

impl CellCase {
    /// The number of the vertex of the sheet through the crossing of `edge`.
    #[inline]
    pub fn vertex(&self, table: &CaseTable, edge: Edge) -> u32 {
        self.first_vertex + table.case(self.case).sheet_of(edge)
    }
}

/// The vertices of all sheets.
pub struct Placements {
    /// Positions, by vertex number.
    pub vertices: Vec<[f64; 3]>,
    /// By leaf the vertices that ought to be elsewhere.
    pub wishes: Vec<Vec<Wish>>,
    /// Counts of cells and vertices by kind.
    pub statistics: ContourStatistics,
}

impl<'a> Cells<'a> {
    /// Finds the cases of all active cells, and the positions of their vertices. Counts cells and vertices
    /// by kind.
    ///
    /// # Errors
    /// When the run is cancelled.
    pub fn place(
        signs: &'a SignField,
        crossings: &'a Crossings,
        grid: Grid,
        slab: Slab,
        numbers: &'a CellNumbers,
        surface: Option<&'a dyn Surface>,
        phase: &PhaseGuard<'_>,
    ) -> Result<(Cells<'a>, Placements), Cancelled> {
        let bend = surface.map_or(Bend::UNKNOWN, Bend::of);
        let features = Features::new(Vec::new(), 0, bend);
        let (jumps, cases, crowded) = (VertexSet::default(), Vec::new(), Vec::new());
        let mut cells =
            Cells { signs, crossings, grid, slab, numbers, surface, features, jumps, cases, crowded };
        let mut cases: Vec<CellCase> = bytemuck::zeroed_vec(numbers.len());
        // Face and edge vertices come after them, and the whole need not move for those few. Room that is not used is not
        // touched.
        let count = numbers.vertices() as usize;
        let mut vertices = vec![[0.0; 3]; count + count / SPARE];
        vertices.truncate(count);
        let leaves: Vec<LeafId> = numbers.leaves().collect();
        let case_slices = split(&mut cases, leaves.iter().map(|&leaf| numbers.range(leaf).len()));
        let vertex_slices = split(&mut vertices, leaves.iter().map(|&leaf| numbers.vertex_range(leaf).len()));
        let placed: Vec<LeafVertices> = leaves
            .par_iter()
            .zip(case_slices)
            .zip(vertex_slices)
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|((&leaf, cases), vertices)| {
                phase.advance(1)?;
                Ok(LeafVertices::place(&cells, leaf, cases, vertices))
            })
            .collect::<Result<_, Cancelled>>()?;
        cells.cases = cases;
        cells.crowded = vec![false; signs.len()];
        let mut statistics = ContourStatistics::default();
        let mut wishes = vec![Vec::new(); signs.len()];
        let mut features = Vec::with_capacity(placed.iter().map(|own| own.features.len()).sum());
        let mut jumps = Vec::new();
        for (own, &leaf) in placed.into_iter().zip(&leaves) {
            cells.crowded[leaf.0 as usize] = own.is_crowded;
            wishes[leaf.0 as usize] = own.wishes;
            features.extend(own.features);
            jumps.extend(own.jumps);
            if cells.owns(leaf) {
                statistics.cells += numbers.range(leaf).len() as u64;
                statistics.several_sheets += u64::from(own.several_sheets);
                statistics.clamped += u64::from(own.clamped);
            }
        }
        cells.jumps = VertexSet::new(jumps.into_iter(), vertices.len());
        cells.features = Features::new(features, vertices.len(), bend);
        Ok((cells, Placements { vertices, wishes, statistics }))
    }

    /// Whether a leaf is counted.
    pub fn owns(&self, leaf: LeafId) -> bool {
        self.slab.owns(self.signs.origin(leaf))
    }

    /// Whether a leaf has a crowded cell, in which sheets can get in each other's way. Few have.
    pub fn is_crowded(&self, leaf: LeafId) -> bool {
        self.crowded[leaf.0 as usize]
    }

    /// The case of `cell`.
    #[inline]
    pub fn case(&self, cell: CellId) -> &'static Case {
        CaseTable::get().case(self.cases[cell.0 as usize].case)
    }

    /// The number of the vertex of the sheet of `cell` through the crossing of `edge`.
    #[inline]
    pub fn vertex(&self, cell: CellId, edge: Edge) -> u32 {
        self.cell_case(cell).vertex(CaseTable::get(), edge)
    }

    /// The case of `cell`, and its vertices.
    #[inline]
    pub fn cell_case(&self, cell: CellId) -> CellCase {
        self.cases[cell.0 as usize]
    }
}

/// Cuts a slice into consecutive parts of the given lengths.
pub fn split<T>(mut slice: &mut [T], lengths: impl Iterator<Item = usize>) -> Vec<&mut [T]> {
    lengths
        .map(|length| {
            let (part, rest) = std::mem::take(&mut slice).split_at_mut(length);
            slice = rest;
            part
        })
        .collect()
}
