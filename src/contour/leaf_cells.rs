//! The vertices of the cells around the edges of one leaf, in a plain array: each cell is asked for by up to twelve
//! edges, and finding it among all cells takes longer than what is done with it.

use super::cell::Edge;
use super::cells::{CellCase, Cells};
use super::face_vertex::FaceVertices;
use super::numbering::CellId;
use super::sheets::CaseTable;
use crate::band::{Axis, Ijk, LEAF_DIM, LeafId, LeafMask};
use crate::edge::bits;

/// Cells along each axis: those of the leaf, and the last ones of the leaf before.
const SIDE: usize = LEAF_DIM as usize + 1;

/// The cells around the edges that start in a leaf: the leaf's own, and the last ones of the leaves before.
pub struct LeafCells<'a> {
    cells: &'a Cells<'a>,
    table: &'static CaseTable,
    leaf: LeafId,
    /// By cell, z fastest. Only those of active cells mean something.
    cases: [CellCase; SIDE * SIDE * SIDE],
    /// The face vertices, if there are any on these cells.
    faces: Option<&'a FaceVertices>,
}

/// The place of a cell in the array, from its coordinates in the leaf, -1 to 7 each.
#[inline]
fn place([x, y, z]: [i32; 3]) -> usize {
    ((x + 1) as usize * SIDE + (y + 1) as usize) * SIDE + (z + 1) as usize
}

impl<'a> LeafCells<'a> {
    /// Those around the edges of `leaf`.
    pub fn new(cells: &'a Cells<'a>, faces: &'a FaceVertices, leaf: LeafId) -> LeafCells<'a> {
        let mut around = LeafCells {
            cells,
            table: CaseTable::get(),
            leaf,
            cases: [CellCase::default(); SIDE * SIDE * SIDE],
            faces: None,
        };
        for n in 0..8 {
            let delta = [-(n >> 2), -(n >> 1 & 1), -(n & 1)];
            let Some(other) = cells.signs.neighbour(leaf, delta) else { continue };
            if !faces.range(other).is_empty() {
                around.faces = Some(faces);
            }
            let active = cells.numbers.active(other);
            let wanted = last_layers(active, delta);
            for number in bits(&wanted) {
                let CellId(cell) = cells.numbers.id(other, number);
                let local = Ijk::in_leaf(Ijk(delta.map(|d| LEAF_DIM * d)), number);
                around.cases[place(local.0)] = cells.cell_case(CellId(cell));
            }
        }
        around
    }

    /// The number of the vertex of the sheet of the cell at `local` through the crossing of `edge`.
    #[inline]
    pub fn vertex(&self, local: [i32; 3], edge: Edge) -> u32 {
        self.cases[place(local)].vertex(self.table, edge)
    }

    /// Whether there can be face vertices on these cells.
    #[inline]
    pub fn have_face_vertices(&self) -> bool {
        self.faces.is_some()
    }

    /// The number of the face vertex between the cell at `local` and the next one along `axis`, on the pair with the
    /// crossing of `edge`, if there is one.
    #[inline]
    pub fn face_vertex(&self, local: [i32; 3], axis: Axis, edge: Edge) -> Option<u32> {
        let faces = self.faces?;
        let cells = self.cells;
        let (leaf, cell) = cells.numbers.locate(cells.signs, self.leaf, local);
        faces.get(leaf, cell, cells.case(cell), axis, edge)
    }
}

/// The bits of a mask in the last layers along the axes in which `delta` is -1.
fn last_layers(mask: &LeafMask, [x, y, z]: [i32; 3]) -> LeafMask {
    const Y_LAST: u64 = 0xff << 56;
    const Z_LAST: u64 = 0x8080_8080_8080_8080;
    let rows = if y == 0 { !0 } else { Y_LAST } & if z == 0 { !0 } else { Z_LAST };
    std::array::from_fn(|n| if x == 0 || n == 7 { mask[n] & rows } else { 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_layers_are_those_with_a_seven() {
        for n in 0..8i32 {
            let delta = [-(n >> 2), -(n >> 1 & 1), -(n & 1)];
            let kept = last_layers(&[!0; 8], delta);
            let found: Vec<usize> = bits(&kept).collect();
            let is_last = |&n: &usize| {
                let local = Ijk::in_leaf(Ijk::default(), n).0;
                (0..3).all(|a| delta[a] == 0 || local[a] == 7)
            };
            assert_eq!(found, (0..512).filter(is_last).collect::<Vec<_>>(), "{delta:?}");
        }
    }
}
