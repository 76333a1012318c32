//! Which cells are active, and their numbers: bit masks and ranks per leaf, no hash map.
//!
//! A cell belongs to the leaf of its lowest corner and has that corner's number in it. It is active when
//! its corners have both signs.

use super::case_table::{CaseId, CaseTable, FaceChoice};
use crate::band::{LeafId, SignField};
use crate::contour::error::{ContourError, TooManyVertices};
use crate::lattice::{LeafMask, Z_FIRST, Z_LAST, bits};
use crate::run::{RunSettings, SHARE};
use rayon::prelude::*;

/// Signs of the corners of a leaf's cells: word `x` of `planes[x][dy + 2 dz]` holds for each (y, z) the
/// sign of the node (x, y + dy, z + dz), with x in 0..=8.
pub struct CornerSigns {
    planes: [[u64; 4]; 9],
}

impl CornerSigns {
    /// The corner signs of `leaf`; `None` when its cells are all of one sign. A neighbour that the field
    /// lacks counts as a continuation of a uniform leaf: the field has all neighbours of others.
    pub fn new(signs: &SignField, leaf: LeafId) -> Option<CornerSigns> {
        let own = signs.inside(leaf);
        let uniform = [own[0]; 8];
        let at = |delta| signs.neighbour(leaf, delta).map_or(&uniform, |n| signs.inside(n));
        let leaves =
            [[[0, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1]], [[1, 0, 0], [1, 1, 0], [1, 0, 1], [1, 1, 1]]]
                .map(|side| side.map(at));
        let all = |word: u64| leaves.iter().flatten().all(|mask| **mask == [word; 8]);
        if all(0) || all(!0) {
            return None;
        }
        let planes = std::array::from_fn(|x| {
            let [a, y, z, yz] = leaves[x / 8].map(|mask| mask[x % 8]);
            let next_z = |word: u64, after: u64| ((word >> 1) & !Z_LAST) | ((after & Z_FIRST) << 7);
            let next_y = |word: u64, after: u64| (word >> 8) | (after << 56);
            [a, next_y(a, y), next_z(a, z), next_y(next_z(a, z), next_z(y, yz))]
        });
        Some(CornerSigns { planes })
    }

    /// The active cells.
    pub fn active(&self) -> LeafMask {
        std::array::from_fn(|x| {
            let corners = self.planes[x..x + 2].as_flattened();
            corners.iter().fold(0, |any, w| any | w) & !corners.iter().fold(!0, |all, w| all & w)
        })
    }

    /// Cells that may have several sheets, and few others.
    pub fn crowded(&self) -> LeafMask {
        std::array::from_fn(|x| crowded([self.planes[x], self.planes[x + 1]]))
    }

    /// The mask of inside corners of the cell with `number`, bit dx + 2 dy + 4 dz.
    #[inline]
    pub fn mask(&self, number: usize) -> u8 {
        let (x, bit) = (number >> 6, number & 63);
        let pick = |plane: usize, row: usize| (self.planes[plane][row] >> bit & 1) as u8;
        (0..4).fold(0, |mask, row| mask | pick(x, row) << (2 * row) | pick(x + 1, row) << (2 * row + 1))
    }
}

/// Of 64 cells, a bit each, those that may have several sheets, by the signs of their corners: `corners[dx][dy + 2 dz]`. Such
/// a cell has a face whose signs alternate, or two opposite corners that differ from all their neighbours.
fn crowded(corners: [[u64; 4]; 2]) -> u64 {
    let alternates = |a: u64, b: u64, c: u64, d: u64| (a ^ b) & !(a ^ c) & !(b ^ d);
    let [low, high] = corners;
    let across_x = [low, high].map(|[a, b, d, c]| alternates(a, b, c, d));
    // The rows at the lower and the upper face across y, then across z.
    let along_x = [(0, 2), (1, 3), (0, 1), (2, 3)].map(|(a, b)| alternates(low[a], high[a], high[b], low[b]));
    let differs = |x: usize, row: usize| {
        let own = corners[x][row];
        (own ^ corners[1 - x][row]) & (own ^ corners[x][row ^ 1]) & (own ^ corners[x][row ^ 2])
    };
    let opposite = [0, 1, 2, 3].map(|row| differs(0, row) & differs(1, row ^ 3));
    across_x.into_iter().chain(along_x).chain(opposite).fold(0, |all, cells| all | cells)
}

/// The number of an active cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CellId(pub u32);

#[derive(Clone, Copy, Debug)]
struct LeafCells {
    active: LeafMask,
    /// Active cells of the leaf before word x.
    before: [u16; 8],
    /// The number of the first active cell.
    first_cell: u32,
    /// The number of the first cell vertex.
    first_vertex: u32,
}

/// The numbering of active cells and of their vertices.
#[derive(Debug)]
pub struct CellNumbers {
    leaves: Vec<LeafCells>,
    cells: u32,
    vertices: u32,
}

impl CellNumbers {
    /// Numbers the active cells of `signs`, and their sheets.
    ///
    /// # Errors
    /// When there are more than 2^32 - 1 sheets, or the run is cancelled.
    pub fn new(signs: &SignField, run: &RunSettings) -> Result<CellNumbers, ContourError> {
        let table = CaseTable::get();
        let ids: Vec<LeafId> = signs.leaves().collect();
        let mut leaves: Vec<LeafCells> = ids
            .into_par_iter()
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|leaf| {
                run.check()?;
                let mut cells = LeafCells { active: [0; 8], before: [0; 8], first_cell: 0, first_vertex: 0 };
                if let Some(corners) = CornerSigns::new(signs, leaf) {
                    cells.active = corners.active();
                    // Half of the corners of the last cells are not known.
                    if signs.is_border(leaf, 1) {
                        cells.active[7] = 0;
                    }
                    let mut count = 0;
                    for (word, before) in cells.active.iter().zip(&mut cells.before) {
                        *before = count;
                        count += word.count_ones() as u16;
                    }
                    // Counts for now; the prefix sums follow.
                    cells.first_cell = u32::from(count);
                    let crowded = corners.crowded();
                    let crowded = std::array::from_fn(|x| crowded[x] & cells.active[x]);
                    let more =
                        |n: usize| table.case(constant_case(table, corners.mask(n))).sheets().len() - 1;
                    cells.first_vertex =
                        cells.first_cell + bits(&crowded).map(|n| more(n) as u32).sum::<u32>();
                }
                Ok(cells)
            })
            .collect::<Result<_, ContourError>>()?;
        let (mut cells, mut vertices) = (0u32, 0u32);
        for leaf in &mut leaves {
            let next = (cells.checked_add(leaf.first_cell), vertices.checked_add(leaf.first_vertex));
            (leaf.first_cell, leaf.first_vertex) = (cells, vertices);
            let (Some(next_cells), Some(next_vertices)) = next else { return Err(TooManyVertices.into()) };
            (cells, vertices) = (next_cells, next_vertices);
        }
        Ok(CellNumbers { leaves, cells, vertices })
    }

    /// The number of active cells.
    pub fn len(&self) -> usize {
        self.cells as usize
    }

    /// The number of cell vertices.
    pub fn vertices(&self) -> u32 {
        self.vertices
    }

    /// The leaves with active cells, ascending.
    pub fn leaves(&self) -> impl Iterator<Item = LeafId> + '_ {
        (0..self.leaves.len() as u32).map(LeafId).filter(|&leaf| !self.range(leaf).is_empty())
    }

    /// The active cells of `leaf`.
    pub fn active(&self, leaf: LeafId) -> &LeafMask {
        &self.leaves[leaf.0 as usize].active
    }

    /// The numbers of the active cells of `leaf`, a contiguous range.
    pub fn range(&self, leaf: LeafId) -> std::ops::Range<usize> {
        let end = self.leaves.get(leaf.0 as usize + 1).map_or(self.cells, |next| next.first_cell);
        self.leaves[leaf.0 as usize].first_cell as usize..end as usize
    }

    /// The numbers of the cell vertices of `leaf`, a contiguous range.
    pub fn vertex_range(&self, leaf: LeafId) -> std::ops::Range<usize> {
        let end = self.leaves.get(leaf.0 as usize + 1).map_or(self.vertices, |next| next.first_vertex);
        self.leaves[leaf.0 as usize].first_vertex as usize..end as usize
    }

    /// The number of the active cell with `number` in `leaf`.
    ///
    /// # Panics
    /// When that cell is not active.
    #[inline]
    pub fn id(&self, leaf: LeafId, number: usize) -> CellId {
        let cells = &self.leaves[leaf.0 as usize];
        let (word, bit) = (number >> 6, number & 63);
        assert!(cells.active[word] >> bit & 1 == 1, "a cell around a crossed edge is active");
        let below = (cells.active[word] & ((1 << bit) - 1)).count_ones();
        CellId(cells.first_cell + u32::from(cells.before[word]) + below)
    }

    /// The number of the active cell at `local`, in nodes from the origin of `leaf`, and the leaf that
    /// the cell belongs to.
    #[inline]
    pub fn locate(&self, signs: &SignField, leaf: LeafId, local: [i32; 3]) -> (LeafId, CellId) {
        let (leaf, number) = locate(signs, leaf, local);
        (leaf, self.id(leaf, number))
    }
}

/// The leaf and number of the node or cell `local`, given in nodes from the origin of `leaf`.
///
/// # Panics
/// When the field does not contain it.
#[inline]
pub fn locate(signs: &SignField, leaf: LeafId, local: [i32; 3]) -> (LeafId, usize) {
    if (local[0] | local[1] | local[2]) & !7 == 0 {
        return (leaf, (64 * local[0] + 8 * local[1] + local[2]) as usize);
    }
    signs.locate(leaf, local).expect("the cells around a sign change lie in the sign field")
}

/// The case of a mask under the rule for ambiguous faces that is in use: a constant one.
#[inline]
pub fn constant_case(table: &CaseTable, mask: u8) -> CaseId {
    table.id(mask, FaceChoice::INSIDE_APART)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::cell::topology::Face;

    #[test]
    fn cells_with_several_sheets_or_an_ambiguous_face_are_crowded() {
        let table = CaseTable::get();
        let (mut several, mut all) = (0, 0);
        for first in [0, 64, 128, 192] {
            // Cell n has the mask first + n.
            let corner = |bit: usize| (0..64).fold(0, |word, n| word | ((first + n) >> bit & 1) << n);
            let corners = [0, 1].map(|dx| [0, 1, 2, 3].map(|row| corner(dx + 2 * row)));
            let found = crowded(corners);
            for n in 0..64u64 {
                let case = table.case(constant_case(table, (first + n) as u8));
                let is_found = found >> n & 1 == 1;
                let is_needed = case.has_several_sheets() || Face::all().any(|face| case.is_ambiguous(face));
                assert!(is_found || !is_needed, "{}", first + n);
                several += u32::from(case.has_several_sheets());
                all += u32::from(is_found);
            }
        }
        assert!(several > 50 && all < 200, "{several} of {all}");
    }
}
