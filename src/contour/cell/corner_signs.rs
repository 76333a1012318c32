//! The signs of the corners of a leaf's cells, 64 cells to a word.

use crate::band::{LeafId, SignField};
use crate::lattice::{LeafMask, Z_FIRST, Z_LAST};

/// The signs of the corners of a leaf's cells; a set bit is inside.
pub struct CornerSigns {
    /// Word `planes[x][dy + 2 dz]` has for each (y, z) the sign of the node (x, y + dy, z + dz),
    /// with x in 0..=8.
    planes: [[u64; 4]; 9],
}

impl CornerSigns {
    /// Collects the corner signs of `leaf`; `None` when its cells are all of one sign.
    ///
    /// A neighbour that the field lacks counts as a continuation of a uniform leaf: the field has
    /// all neighbours of others.
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

    /// Returns the active cells.
    pub fn active(&self) -> LeafMask {
        std::array::from_fn(|x| {
            let corners = self.planes[x..x + 2].as_flattened();
            corners.iter().fold(0, |any, w| any | w) & !corners.iter().fold(!0, |all, w| all & w)
        })
    }

    /// Returns the cells that may be ambiguous or have several sheets, and few others.
    pub fn maybe_ambiguous(&self) -> LeafMask {
        std::array::from_fn(|x| maybe_ambiguous([self.planes[x], self.planes[x + 1]]))
    }

    /// Returns the mask of inside corners of the cell with `number`, bit dx + 2 dy + 4 dz.
    #[inline]
    pub fn mask(&self, number: usize) -> u8 {
        let (x, bit) = (number >> 6, number & 63);
        let pick = |plane: usize, row: usize| (self.planes[plane][row] >> bit & 1) as u8;
        (0..4).fold(0, |mask, row| mask | pick(x, row) << (2 * row) | pick(x + 1, row) << (2 * row + 1))
    }
}

/// Returns those of 64 cells, a bit each, that may be ambiguous or have several sheets, by the
/// signs of their corners `corners[dx][dy + 2 dz]`.
///
/// Such a cell has a face whose signs alternate, or two opposite corners that differ from all their
/// neighbours.
fn maybe_ambiguous(corners: [[u64; 4]; 2]) -> u64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::cell::{CaseTable, Face, constant_case};

    #[test]
    fn cells_with_several_sheets_or_an_ambiguous_face_are_found() {
        let table = CaseTable::get();
        let (mut several, mut all) = (0, 0);
        for first in [0, 64, 128, 192] {
            // Cell n has the mask first + n.
            let corner = |bit: usize| (0..64).fold(0, |word, n| word | ((first + n) >> bit & 1) << n);
            let corners = [0, 1].map(|dx| [0, 1, 2, 3].map(|row| corner(dx + 2 * row)));
            let found = maybe_ambiguous(corners);
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
