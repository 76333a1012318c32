//! The active cells, with their cases and vertices.

use super::context::CellContext;
use crate::band::LeafId;
use crate::contour::cell::{Case, CaseId, CaseTable, CellId, Edge};
use crate::contour::feature::{FeatureMap, VertexSet};

/// The active cells, complete: nothing of them changes once the vertices are placed.
pub struct Cells<'a> {
    /// The inputs.
    pub context: CellContext<'a>,
    /// The vertices on creases and corners.
    pub features: FeatureMap,
    /// The vertices of cells in which the sign jumps
    /// ([`Crossing::is_jump`](crate::edge::Crossing::is_jump)): the surface is elsewhere.
    pub jumps: VertexSet,
    /// The cases by cell.
    cases: Vec<CellCase>,
    /// For each leaf, whether any of its cells may be ambiguous
    /// ([`CornerSigns::maybe_ambiguous`](crate::contour::cell::CornerSigns::maybe_ambiguous)).
    maybe_ambiguous: Vec<bool>,
}

/// The case of an active cell, and the numbers of its vertices.
#[derive(Clone, Copy, Debug, Default, bytemuck::Zeroable)]
pub struct CellCase {
    /// The number of the vertex of sheet 0. The vertices of the other sheets follow.
    pub first_vertex: u32,
    /// The case.
    pub case: CaseId,
}

impl CellCase {
    /// Returns the number of the vertex of the sheet through the crossing of `edge`.
    #[inline]
    pub fn vertex(&self, table: &CaseTable, edge: Edge) -> u32 {
        self.first_vertex + table.case(self.case).sheet_of(edge)
    }
}

impl<'a> Cells<'a> {
    /// Makes the cells from their cases, by cell, and from what is known of their leaves and
    /// vertices.
    pub fn new(
        context: CellContext<'a>,
        cases: Vec<CellCase>,
        maybe_ambiguous: Vec<bool>,
        features: FeatureMap,
        jumps: VertexSet,
    ) -> Cells<'a> {
        Cells { context, features, jumps, cases, maybe_ambiguous }
    }

    /// Whether a leaf has a cell that may be ambiguous, in which sheets can get in each other's
    /// way.
    ///
    /// Few leaves have one.
    pub fn maybe_ambiguous(&self, leaf: LeafId) -> bool {
        self.maybe_ambiguous[leaf.0 as usize]
    }

    /// Returns the case of a cell.
    #[inline]
    pub fn case(&self, cell: CellId) -> &'static Case {
        CaseTable::get().case(self.cases[cell.0 as usize].case)
    }

    /// Returns the number of the vertex of the sheet of `cell` through the crossing of `edge`.
    #[inline]
    pub fn vertex(&self, cell: CellId, edge: Edge) -> u32 {
        self.cell_case(cell).vertex(CaseTable::get(), edge)
    }

    /// Returns the case of a cell, and the numbers of its vertices.
    #[inline]
    pub fn cell_case(&self, cell: CellId) -> CellCase {
        self.cases[cell.0 as usize]
    }
}
