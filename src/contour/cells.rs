//! The active cells: their cases and the vertices of their sheets.

use super::ContourStatistics;
use super::cell::Edge;
use super::feature::Normals;
use super::features::{Bend, FeatureVertex, Features};
use super::grid::Grid;
use super::numbering::{CellId, CellNumbers, CornerSigns, constant_case, locate};
use super::recover::Wish;
use super::sheets::{Case, CaseId, CaseTable};
use super::surface::Surface;
use super::vertex::{self, Placement};
use crate::band::{Ijk, LeafId, SignField};
use crate::edge::{Crossings, bits};
use crate::run::{Cancelled, PhaseGuard};
use crate::slab::Slab;
use rayon::prelude::*;

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
    cases: Vec<CellCase>,
}

/// The case of an active cell, and its vertices.
#[derive(Clone, Copy, Debug, Default)]
struct CellCase {
    /// The number of the vertex of sheet 0; the other sheets' follow.
    first_vertex: u32,
    case: CaseId,
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
        let mut cells = Cells { signs, crossings, grid, slab, numbers, surface, features, cases: Vec::new() };
        let mut cases = vec![CellCase::default(); numbers.len()];
        let mut vertices = vec![[0.0; 3]; numbers.vertices() as usize];
        let leaves: Vec<LeafId> = signs.leaves().collect();
        let case_slices = split(&mut cases, leaves.iter().map(|&leaf| numbers.range(leaf).len()));
        let vertex_slices = split(&mut vertices, leaves.iter().map(|&leaf| numbers.vertex_range(leaf).len()));
        let placed: Vec<(Vec<Wish>, Vec<FeatureVertex>, ContourStatistics)> = leaves
            .par_iter()
            .zip(case_slices)
            .zip(vertex_slices)
            .with_min_len(16)
            .map(|((&leaf, cases), vertices)| {
                phase.advance(1)?;
                Ok(cells.place_in_leaf(leaf, cases, vertices))
            })
            .collect::<Result<_, Cancelled>>()?;
        cells.cases = cases;
        let mut statistics = ContourStatistics::default();
        let mut wishes = Vec::with_capacity(placed.len());
        let mut features = Vec::new();
        for ((wished, found, counts), &leaf) in placed.into_iter().zip(&leaves) {
            wishes.push(wished);
            features.extend(found);
            if cells.owns(leaf) {
                statistics += counts;
            }
        }
        cells.features = Features::new(features, vertices.len(), bend);
        Ok((cells, Placements { vertices, wishes, statistics }))
    }

    /// Whether a leaf is counted.
    pub fn owns(&self, leaf: LeafId) -> bool {
        self.slab.owns(self.signs.origin(leaf))
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
    ) -> (Vec<Wish>, Vec<FeatureVertex>, ContourStatistics) {
        let Cells { signs, crossings, grid, numbers, .. } = self;
        let mut statistics = ContourStatistics { cells: cases.len() as u64, ..Default::default() };
        let (mut wishes, mut features) = (Vec::new(), Vec::new());
        let Some(corners) = CornerSigns::new(signs, leaf) else {
            return (wishes, features, statistics);
        };
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
                let at = signs.origin(leaf) + local;
                let placed = vertex::place(grid, at, case, sheet, crossing, self.surface);
                vertices[done] = placed.position;
                if let Some(feature) = placed.feature {
                    let vertex = first_vertex + done as u32;
                    features.push(FeatureVertex { vertex, feature });
                    if placed.placement == Placement::Clamped {
                        wishes.push(Wish { vertex, place: Some(feature.point) });
                    } else if feature.normals == Normals::default() {
                        wishes.push(Wish { vertex, place: None });
                    }
                }
                done += 1;
                statistics.clamped += u64::from(placed.placement == Placement::Clamped);
            }
        }
        (wishes, features, statistics)
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
