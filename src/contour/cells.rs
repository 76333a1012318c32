//! The active cells: their cases and the vertices of their sheets.

use super::ContourStatistics;
use super::cell::Edge;
use super::grid::Grid;
use super::numbering::{CellId, CellNumbers, CornerSigns, constant_case, locate};
use super::sheets::{Case, CaseId, CaseTable};
use super::vertex::{self, Placement};
use crate::band::{Ijk, LeafId, SignField};
use crate::edge::{Crossings, bits};
use crate::run::{Cancelled, PhaseGuard};
use rayon::prelude::*;

/// The active cells with everything that is known of them.
pub struct Cells<'a> {
    /// The signs of the nodes.
    pub signs: &'a SignField,
    /// The crossings of the edges.
    pub crossings: &'a Crossings,
    /// The rounded lattice.
    pub grid: Grid,
    /// The numbering of the cells.
    pub numbers: &'a CellNumbers,
    cases: Vec<CellCase>,
}

/// The case of an active cell, and its vertices.
#[derive(Clone, Copy, Debug, Default)]
struct CellCase {
    /// The number of the vertex of sheet 0; the other sheets' follow.
    first_vertex: u32,
    case: CaseId,
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
        numbers: &'a CellNumbers,
        phase: &PhaseGuard<'_>,
    ) -> Result<(Cells<'a>, Vec<[f64; 3]>, ContourStatistics), Cancelled> {
        let mut cells = Cells { signs, crossings, grid, numbers, cases: Vec::new() };
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
                Ok(cells.place_in_leaf(leaf, cases, vertices))
            })
            .try_reduce(ContourStatistics::default, |mut a, b| {
                a += b;
                Ok(a)
            })?;
        cells.cases = cases;
        Ok((cells, vertices, statistics))
    }

    /// The case of `cell`.
    #[inline]
    pub fn case(&self, cell: CellId) -> &'static Case {
        CaseTable::get().case(self.cases[cell.0 as usize].case)
    }

    /// The number of the vertex of the sheet of `cell` through the crossing of `edge`.
    #[inline]
    pub fn vertex(&self, cell: CellId, edge: Edge) -> u32 {
        let CellCase { first_vertex, case } = self.cases[cell.0 as usize];
        first_vertex + CaseTable::get().case(case).sheet_of(edge)
    }

    /// Fills in the cases and the vertices of the cells of one leaf.
    fn place_in_leaf(
        &self,
        leaf: LeafId,
        cases: &mut [CellCase],
        vertices: &mut [[f64; 3]],
    ) -> ContourStatistics {
        let Cells { signs, crossings, grid, numbers, .. } = self;
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
