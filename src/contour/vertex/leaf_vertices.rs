//! The vertices of the cells of one leaf.

use super::cell_vertex::{self, Placement, sample};
use super::cells::CellCase;
use super::context::CellContext;
use super::leaf_crossings::LeafCrossings;
use super::qef_batch::{Batch, LANES};
use super::relocation::Relocation;
use crate::band::LeafId;
use crate::contour::cell::{Case, CaseTable, CornerSigns, constant_case};
use crate::contour::feature::{FeatureVertex, Normals};
use crate::lattice::{Ijk, bits};

/// What is found of a leaf's cells besides the positions of their vertices.
#[derive(Debug, Default)]
pub struct LeafVertices {
    /// Vertices that ought to be elsewhere.
    pub relocations: Vec<Relocation>,
    /// Vertices on creases and corners.
    pub features: Vec<FeatureVertex>,
    /// Vertices of cells with a jump of the sign.
    pub jumps: Vec<u32>,
    /// Cells with more than one sheet. Small numbers: most leaves have no cells, and there is this for all.
    pub several_sheets: u16,
    /// See [`ContourStatistics::clamped`](crate::contour::ContourStatistics::clamped).
    pub clamped: u16,
    /// Whether any cell is crowded ([`CornerSigns::crowded`]).
    pub is_crowded: bool,
}

/// A cell that waits for its vertices.
#[derive(Clone, Copy)]
struct Waiting {
    case: &'static Case,
    /// In nodes from the leaf's origin.
    local: Ijk,
    /// The number of its first vertex in the leaf.
    first: usize,
}

/// The cells of a leaf on their way to vertices.
struct Placer<'a> {
    context: &'a CellContext<'a>,
    leaf: LeafId,
    crossings: LeafCrossings<'a>,
    vertices: &'a mut [[f64; 3]],
    batch: Batch,
    waiting: [Option<Waiting>; LANES],
    found: LeafVertices,
}

impl LeafVertices {
    /// Fills in the cases and the vertices of the cells of one leaf.
    pub fn place(
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
        let (batch, waiting) = (Batch::default(), [None; LANES]);
        let found = LeafVertices { is_crowded: corners.crowded() != [0; 8], ..found };
        let mut placer = Placer { context, leaf, crossings, vertices, batch, waiting, found };
        let mut first = 0;
        for (cell, number) in cases.iter_mut().zip(bits(context.numbers.active(leaf))) {
            let id = constant_case(table, corners.mask(number));
            *cell = CellCase { first_vertex: first_vertex + first as u32, case: id };
            let case = table.case(id);
            if context.crossings.numbers.is_partial() && !placer.has_all_crossings(case, number) {
                let vertices = &mut placer.vertices[first..first + case.sheets().len()];
                vertices.fill(cell_vertex::MISSING);
                first += case.sheets().len();
                continue;
            }
            placer.add(Waiting { case, local: Ijk::in_leaf(Ijk::default(), number), first });
            first += case.sheets().len();
        }
        placer.finish();
        placer.found
    }
}

impl Placer<'_> {
    /// Whether no crossing of a cell is missing.
    fn has_all_crossings(&self, case: &Case, number: usize) -> bool {
        let local = Ijk::in_leaf(Ijk::default(), number);
        case.sheets().iter().all(|sheet| self.crossings.has_all(local.0, sheet.edges.iter()))
    }

    /// Takes the next cell.
    #[inline]
    fn add(&mut self, cell: Waiting) {
        if let [sheet] = cell.case.sheets() {
            let samples = sheet.edges.iter().map(|edge| {
                let crossing = self.crossings.of_cell(cell.local.0, edge);
                sample(edge, crossing)
            });
            self.waiting[self.batch.len()] = Some(cell);
            self.batch.push(samples);
            if self.batch.len() == LANES {
                self.finish();
            }
        } else {
            // Vertices are numbered in the order of their cells, and features found in that order.
            self.finish();
            self.found.several_sheets += 1;
            for sheet in 0..cell.case.sheets().len() {
                self.place_one(cell, sheet);
            }
        }
    }

    /// Places the vertices of all cells that wait.
    fn finish(&mut self) {
        let solved = self.batch.solve();
        for n in 0..LANES {
            let Some(cell) = self.waiting[n].take() else { break };
            let at = self.context.signs.origin(self.leaf) + cell.local;
            let smooth =
                solved.smooth(n).and_then(|point| cell_vertex::free(&self.context.lattice, at, point));
            match smooth {
                Some(position) => self.vertices[cell.first] = position,
                None => self.place_one(cell, 0),
            }
        }
    }

    /// Places the vertex of a sheet by itself.
    fn place_one(&mut self, Waiting { case, local, first }: Waiting, sheet: usize) {
        let CellContext { signs, lattice, numbers, surface, .. } = self.context;
        let at = signs.origin(self.leaf) + local;
        let crossing = |edge| self.crossings.of_cell(local.0, edge);
        let placed = cell_vertex::place(lattice, at, case, sheet, crossing, *surface);
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
            self.found.relocations.push(Relocation { vertex, target: Some(feature.point) });
        } else if feature.normals == Normals::default() {
            self.found.relocations.push(Relocation { vertex, target: None });
        }
    }
}
