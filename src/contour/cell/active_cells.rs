//! The numbers of the active cells: bit masks and ranks per leaf, no hash map.
//!
//! A cell belongs to the leaf of its lowest corner and has that corner's number in it. It is active
//! when its corners have both signs.

use super::case_table::{CaseId, CaseTable, FaceChoice};
use super::corner_signs::CornerSigns;
use crate::band::{LeafId, SignField};
use crate::contour::error::ContourError;
use crate::lattice::{LatticeError, LeafMask, bits};
use crate::run::{RunSettings, SHARE};
use rayon::prelude::*;

/// The number of an active cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CellId(pub u32);

/// The active cells of a leaf, and the numbers of the first cell and vertex.
#[derive(Clone, Copy, Debug)]
struct LeafCellRange {
    active: LeafMask,
    /// The number of active cells of the leaf before word x.
    before: [u16; 8],
    /// The number of the first active cell.
    first_cell: u32,
    /// The number of the first cell vertex.
    first_vertex: u32,
}

/// The numbering of active cells and of their vertices.
#[derive(Debug)]
pub struct CellNumbers {
    leaves: Vec<LeafCellRange>,
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
        let mut leaves: Vec<LeafCellRange> = ids
            .into_par_iter()
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|leaf| {
                run.check()?;
                let mut cells =
                    LeafCellRange { active: [0; 8], before: [0; 8], first_cell: 0, first_vertex: 0 };
                if let Some(corners) = CornerSigns::new(signs, leaf) {
                    cells.active = corners.active();
                    // Half of the corners of the last cells are unknown.
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
                    let maybe_ambiguous = corners.maybe_ambiguous();
                    let several = std::array::from_fn(|x| maybe_ambiguous[x] & cells.active[x]);
                    let more =
                        |n: usize| table.case(constant_case(table, corners.mask(n))).sheets().len() - 1;
                    cells.first_vertex =
                        cells.first_cell + bits(&several).map(|n| more(n) as u32).sum::<u32>();
                }
                Ok(cells)
            })
            .collect::<Result<_, ContourError>>()?;
        let (mut cells, mut vertices) = (0u32, 0u32);
        for leaf in &mut leaves {
            let next = (cells.checked_add(leaf.first_cell), vertices.checked_add(leaf.first_vertex));
            (leaf.first_cell, leaf.first_vertex) = (cells, vertices);
            let (Some(next_cells), Some(next_vertices)) = next else {
                return Err(LatticeError::TooManyVertices.into());
            };
            (cells, vertices) = (next_cells, next_vertices);
        }
        Ok(CellNumbers { leaves, cells, vertices })
    }

    /// Returns the number of active cells.
    pub fn len(&self) -> usize {
        self.cells as usize
    }

    /// Returns the number of cell vertices.
    pub fn vertices(&self) -> u32 {
        self.vertices
    }

    /// Returns the leaves with active cells, ascending.
    pub fn leaves(&self) -> impl Iterator<Item = LeafId> + '_ {
        (0..self.leaves.len() as u32).map(LeafId).filter(|&leaf| !self.range(leaf).is_empty())
    }

    /// Returns the active cells of `leaf`.
    pub fn active(&self, leaf: LeafId) -> &LeafMask {
        &self.leaves[leaf.0 as usize].active
    }

    /// Returns the numbers of the active cells of `leaf`, a contiguous range.
    pub fn range(&self, leaf: LeafId) -> std::ops::Range<usize> {
        let end = self.leaves.get(leaf.0 as usize + 1).map_or(self.cells, |next| next.first_cell);
        self.leaves[leaf.0 as usize].first_cell as usize..end as usize
    }

    /// Returns the numbers of the cell vertices of `leaf`, a contiguous range.
    pub fn vertex_range(&self, leaf: LeafId) -> std::ops::Range<usize> {
        let end = self.leaves.get(leaf.0 as usize + 1).map_or(self.vertices, |next| next.first_vertex);
        self.leaves[leaf.0 as usize].first_vertex as usize..end as usize
    }

    /// Returns the number of the active cell with `number` in `leaf`.
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

    /// Returns the leaf and the number of the active cell at `local`, in nodes from the origin of
    /// `leaf`.
    #[inline]
    pub fn locate(&self, signs: &SignField, leaf: LeafId, local: [i32; 3]) -> (LeafId, CellId) {
        let (leaf, number) = locate(signs, leaf, local);
        (leaf, self.id(leaf, number))
    }
}

/// Returns the leaf and the number in it of the node or cell `local`, in nodes from the origin of
/// `leaf`.
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

/// Returns the case of a mask under the rule for ambiguous faces in use: inside corners are kept
/// apart.
#[inline]
pub fn constant_case(table: &CaseTable, mask: u8) -> CaseId {
    table.id(mask, FaceChoice::INSIDE_APART)
}
