//! The vertices of the cells of one leaf.

use super::cell_vertex::{self, Placement, sample};
use super::cells::CellCase;
use super::context::CellContext;
use super::leaf_crossings::LeafCrossings;
use super::qef_batch::{LANES, QefBatch};
use super::relocation::Relocation;
use crate::band::LeafId;
use crate::contour::cell::{Case, CaseTable, CornerSigns, constant_case};
use crate::contour::feature::{FeatureVertex, Normals};
use crate::lattice::{Ijk, bits};

/// The results for a leaf's cells besides the positions of their vertices.
#[derive(Debug, Default)]
pub struct LeafVertices {
    /// Vertices that belong elsewhere.
    pub relocations: Vec<Relocation>,
    /// Vertices on creases and corners.
    pub features: Vec<FeatureVertex>,
    /// Vertices of cells in which the sign jumps.
    pub jumps: Vec<u32>,
    /// The number of cells with more than one sheet. 16 bits, since this is kept for all leaves.
    pub several_sheets: u16,
    /// The number of clamped vertices
    /// ([`ContourStatistics::clamped`](crate::contour::ContourStatistics::clamped)).
    pub clamped: u16,
    /// Whether any cell may be ambiguous ([`CornerSigns::maybe_ambiguous`]).
    pub maybe_ambiguous: bool,
}

/// A cell whose vertex is still to be solved.
#[derive(Clone, Copy)]
struct PendingCell {
    case: &'static Case,
    /// The cell, in nodes from the leaf's origin.
    local: Ijk,
    /// The number of the cell's first vertex in the leaf.
    first: usize,
}

/// A leaf whose vertices are being solved, in the order of its cells.
struct LeafVertexSolver<'a> {
    context: &'a CellContext<'a>,
    leaf: LeafId,
    crossings: LeafCrossings<'a>,
    vertices: &'a mut [[f64; 3]],
    batch: QefBatch,
    pending: [Option<PendingCell>; LANES],
    found: LeafVertices,
}

impl LeafVertices {
    /// Fills in the cases and the vertices of the cells of one leaf, and returns what else is
    /// found.
    pub fn solve(
        context: &CellContext<'_>,
        leaf: LeafId,
        cases: &mut [CellCase],
        vertices: &mut [[f64; 3]],
    ) -> LeafVertices {
        let found = LeafVertices::default();
        if cases.is_empty() {
            return found;
        }
        let Some(corners) = CornerSigns::new(context.signs, leaf) else { return found };
        let crossings = LeafCrossings::new(context.signs, context.crossings, leaf);
        let table = CaseTable::get();
        let first_vertex = context.numbers.vertex_range(leaf).start as u32;
        let (batch, pending) = (QefBatch::default(), [None; LANES]);
        let found = LeafVertices { maybe_ambiguous: corners.maybe_ambiguous() != [0; 8], ..found };
        let mut solver = LeafVertexSolver { context, leaf, crossings, vertices, batch, pending, found };
        let mut first = 0;
        for (cell, number) in cases.iter_mut().zip(bits(context.numbers.active(leaf))) {
            let id = constant_case(table, corners.mask(number));
            *cell = CellCase { first_vertex: first_vertex + first as u32, case: id };
            let case = table.case(id);
            if context.crossings.numbers.is_partial() && !solver.has_all_crossings(case, number) {
                let vertices = &mut solver.vertices[first..first + case.sheets().len()];
                vertices.fill(cell_vertex::MISSING);
                first += case.sheets().len();
                continue;
            }
            solver.add(PendingCell { case, local: Ijk::in_leaf(Ijk::default(), number), first });
            first += case.sheets().len();
        }
        solver.finish();
        solver.found
    }
}

impl LeafVertexSolver<'_> {
    /// Whether all edges of a cell's sheets have crossings.
    fn has_all_crossings(&self, case: &Case, number: usize) -> bool {
        let local = Ijk::in_leaf(Ijk::default(), number);
        case.sheets().iter().all(|sheet| self.crossings.has_all(local.0, sheet.edges.iter()))
    }

    /// Adds the next cell.
    #[inline]
    fn add(&mut self, cell: PendingCell) {
        if let [sheet] = cell.case.sheets() {
            let samples = sheet.edges.iter().map(|edge| {
                let crossing = self.crossings.of_cell(cell.local.0, edge);
                sample(edge, crossing)
            });
            self.pending[self.batch.len()] = Some(cell);
            self.batch.push(samples);
            if self.batch.len() == LANES {
                self.finish();
            }
        } else {
            // Vertices are numbered in the order of their cells, and features must be found in that
            // order.
            self.finish();
            self.found.several_sheets += 1;
            for sheet in 0..cell.case.sheets().len() {
                self.place_one(cell, sheet);
            }
        }
    }

    /// Places the vertices of all pending cells.
    fn finish(&mut self) {
        let solved = self.batch.solve();
        for n in 0..LANES {
            let Some(cell) = self.pending[n].take() else { break };
            let at = self.context.signs.origin(self.leaf) + cell.local;
            let smooth =
                solved.smooth(n).and_then(|point| cell_vertex::free(&self.context.lattice, at, point));
            match smooth {
                Some(position) => self.vertices[cell.first] = position,
                None => self.place_one(cell, 0),
            }
        }
    }

    /// Places the vertex of one sheet by itself.
    fn place_one(&mut self, PendingCell { case, local, first }: PendingCell, sheet: usize) {
        let CellContext { signs, lattice, numbers, surface, .. } = self.context;
        let at = signs.origin(self.leaf) + local;
        let crossing = |edge| self.crossings.of_cell(local.0, edge);
        let placed = cell_vertex::place_vertex(lattice, at, case, sheet, crossing, *surface);
        let number = first + sheet;
        self.vertices[number] = placed.position;
        self.found.clamped += u16::from(placed.placement == Placement::Clamped);
        let vertex = (numbers.vertex_range(self.leaf).start + number) as u32;
        if placed.is_jump {
            self.found.jumps.push(vertex);
        }
        let Some(feature) = placed.feature else { return };
        self.found.features.push(FeatureVertex { vertex, feature });
        if placed.placement == Placement::Clamped {
            self.found.relocations.push(Relocation { vertex, target: Some(feature.point.to_array()) });
        } else if feature.normals == Normals::default() {
            self.found.relocations.push(Relocation { vertex, target: None });
        }
    }
}
