//! The vertices of the cells around the edges of one leaf, in a plain array.
//!
//! Each cell is looked up by up to twelve edges, and finding it among all cells takes longer than
//! the work on it.

use crate::band::LeafId;
use crate::contour::cell::{CaseTable, CellId, Edge};
use crate::contour::vertex::{CellCase, Cells, FaceVertices};
use crate::lattice::{Axis, Ijk, LEAF_DIM, bits, facing_layer};

/// The number of cells along each axis: those of the leaf, and the last ones of the leaf before.
const WIDTH: usize = LEAF_DIM as usize + 1;

/// The cells around the edges that start in a leaf: the leaf's own, and the last ones of the leaves
/// before.
pub struct LeafCells<'a> {
    cells: &'a Cells<'a>,
    table: &'static CaseTable,
    leaf: LeafId,
    /// The cases by cell, z fastest. Only entries of active cells mean something.
    cases: [CellCase; WIDTH * WIDTH * WIDTH],
    /// The face vertices, if there are any on these cells.
    faces: Option<&'a FaceVertices>,
    /// Whether any of these leaves has a cell that may be ambiguous. Only then can a cell have
    /// several sheets.
    maybe_ambiguous: bool,
}

/// Returns the array index of a cell, from its coordinates in the leaf, -1 to 7 each.
#[inline]
fn index([x, y, z]: [i32; 3]) -> usize {
    ((x + 1) as usize * WIDTH + (y + 1) as usize) * WIDTH + (z + 1) as usize
}

impl<'a> LeafCells<'a> {
    /// Collects the cells around the edges of `leaf`.
    pub fn new(cells: &'a Cells<'a>, faces: &'a FaceVertices, leaf: LeafId) -> LeafCells<'a> {
        let mut around = LeafCells {
            cells,
            table: CaseTable::get(),
            leaf,
            cases: [CellCase::default(); WIDTH * WIDTH * WIDTH],
            faces: None,
            maybe_ambiguous: false,
        };
        for n in 0..8 {
            let delta = [-(n >> 2), -(n >> 1 & 1), -(n & 1)];
            let Some(other) = cells.context.signs.neighbour(leaf, delta) else { continue };
            around.maybe_ambiguous |= cells.maybe_ambiguous(other);
            if !faces.range(other).is_empty() {
                around.faces = Some(faces);
            }
            let active = cells.context.numbers.active(other);
            let index = |number| index(Ijk::in_leaf(Ijk(delta.map(|d| LEAF_DIM * d)), number).0);
            if other == leaf {
                for (number, cell) in bits(active).zip(cells.context.numbers.range(leaf)) {
                    around.cases[index(number)] = cells.cell_case(CellId(cell as u32));
                }
                continue;
            }
            for number in bits(&facing_layer(active, delta)) {
                around.cases[index(number)] = cells.cell_case(cells.context.numbers.id(other, number));
            }
        }
        around
    }

    /// Returns the number of the vertex of the sheet of the cell at `local` through the crossing of
    /// `edge`.
    #[inline]
    pub fn vertex(&self, local: [i32; 3], edge: Edge) -> u32 {
        self.cases[index(local)].vertex(self.table, edge)
    }

    /// Returns the vertices of the four cells around the edge from node `local` along `axis`,
    /// counter-clockwise seen from its upper end; `None` where a cell may have several.
    #[inline]
    pub fn single_vertices(&self, local: [i32; 3], axis: Axis) -> Option<[u32; 4]> {
        const STRIDES: [usize; 3] = [WIDTH * WIDTH, WIDTH, 1];
        let (u, v) = axis.others();
        let (cell, u, v) = (index(local), STRIDES[u as usize], STRIDES[v as usize]);
        (!self.maybe_ambiguous)
            .then(|| [cell, cell - u, cell - u - v, cell - v].map(|cell| self.cases[cell].first_vertex))
    }

    /// Whether there can be face vertices on these cells.
    #[inline]
    pub fn have_face_vertices(&self) -> bool {
        self.faces.is_some()
    }

    /// Returns the number of the face vertex between the cell at `local` and the next one along
    /// `axis`, on the pair with the crossing of `edge`, if there is one.
    #[inline]
    pub fn face_vertex(&self, local: [i32; 3], axis: Axis, edge: Edge) -> Option<u32> {
        let faces = self.faces?;
        let cells = self.cells;
        let (leaf, cell) = cells.context.numbers.locate(cells.context.signs, self.leaf, local);
        faces.get(leaf, cell, cells.case(cell), axis, edge)
    }
}
