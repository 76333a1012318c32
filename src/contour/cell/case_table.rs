//! The case table: the sheets of a cell for every mask of inside corners.
//!
//! On each face the crossings are joined in pairs. A face with four crossings is *ambiguous*: its
//! crossings can be joined in two ways, around its inside corners or around its outside corners.
//! Both cells at the face must choose alike. The pairs of a cell close up to cycles, the *sheets*,
//! and each sheet gets one vertex. \[LW11\] section VI leaves such cells open.
//!
//! Of several sheets in a cell all but at most one are *caps*. A plane, the *wall*, cuts off each
//! cap:
//!
//! ```text
//!   corner cap: the three crossings at a corner;   wall: through the corner's three neighbours
//!   edge cap:   the four crossings next to an edge whose ends have one sign;
//!                                                  wall: through the four neighbours of its ends
//! ```

use super::topology::{Corner, Edge, EdgeSet, Face};
use std::sync::LazyLock;

/// The most sheets of a cell: the four caps of a checkerboard.
pub const MAX_SHEETS: usize = 4;

/// The choice for each ambiguous face of a cell: a bit per face, 0 to join around the inside
/// corners, 1 around the outside corners. Bits of other faces mean nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceChoice(u8);

impl FaceChoice {
    /// The choice of inside corners for every face, so that inside corners that touch along a
    /// face's diagonal only come apart.
    pub const INSIDE_APART: FaceChoice = FaceChoice(0);

    /// Makes a choice from bits, bit i for the face with number i.
    pub const fn from_bits(bits: u8) -> FaceChoice {
        FaceChoice(bits)
    }
}

/// The shape of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetKind {
    /// No cap. A cell with several sheets has at most one of this kind.
    Main,
    /// A cap through the three crossings at this corner.
    CornerCap(Corner),
    /// A cap through the four crossings next to this edge.
    EdgeCap(Edge),
}

/// A cycle of pairs in a cell.
#[derive(Clone, Copy, Debug)]
pub struct Sheet {
    /// The edges whose crossings are in the sheet.
    pub edges: EdgeSet,
    /// Cap or main sheet.
    pub kind: SheetKind,
}

/// Two crossings of one face that the contour joins.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The edges of the two crossings.
    pub edges: [Edge; 2],
    /// The corner that both edges share, if there is one.
    pub around: Option<Corner>,
}

/// One row of the table.
#[derive(Clone, Debug)]
pub struct Case {
    sheets: Vec<Sheet>,
    sheet_of: [u8; 12],
    pairs: [Vec<Pair>; 6],
    ambiguous: u8,
}

/// Marks edges that are not crossed.
const NO_SHEET: u8 = u8::MAX;

impl Case {
    fn new(mask: u8, choice: FaceChoice) -> Case {
        let inside = |c: Corner| mask & c.bit() != 0;
        let pairs: [Vec<Pair>; 6] = Face::all()
            .map(|face| face_pairs(face, mask, choice))
            .collect::<Vec<_>>()
            .try_into()
            .expect("six");
        let ambiguous = Face::all().filter(|f| pairs[f.index()].len() == 2).fold(0, |m, f| m | f.bit());
        let mut sheets: Vec<EdgeSet> = Vec::new();
        let mut sheet_of = [NO_SHEET; 12];
        for first in Edge::all().filter(|e| inside(e.low()) != inside(e.high())) {
            if sheet_of[first.index()] != NO_SHEET {
                continue;
            }
            let mut edges = EdgeSet::default();
            let mut next = Some(first);
            while let Some(edge) = next {
                edges.insert(edge);
                sheet_of[edge.index()] = sheets.len() as u8;
                let partners =
                    pairs.iter().flatten().filter(|p| p.edges.contains(&edge)).flat_map(|p| p.edges);
                next = partners.into_iter().find(|&e| !edges.contains(e));
            }
            sheets.push(edges);
        }
        let sheets = sheets.into_iter().map(|edges| Sheet { edges, kind: kind(edges) }).collect();
        Case { sheets, sheet_of, pairs, ambiguous }
    }

    /// Returns the sheets, ordered by their lowest edge.
    #[inline]
    pub fn sheets(&self) -> &[Sheet] {
        &self.sheets
    }

    /// Whether the cell has several sheets.
    #[inline]
    pub fn has_several_sheets(&self) -> bool {
        self.sheets.len() > 1
    }

    /// Returns the number of the sheet through the crossing of `edge`.
    ///
    /// # Panics
    /// When the edge is not crossed.
    #[inline]
    pub fn sheet_of(&self, edge: Edge) -> u32 {
        let sheet = self.sheet_of[edge.index()];
        assert!(sheet != NO_SHEET, "the edge changes sign");
        u32::from(sheet)
    }

    /// Whether `face` has four crossings.
    #[inline]
    pub fn is_ambiguous(&self, face: Face) -> bool {
        self.ambiguous & face.bit() != 0
    }

    /// Returns the pairs of `face`: none, one, or two if it is ambiguous.
    #[inline]
    pub fn pairs(&self, face: Face) -> &[Pair] {
        &self.pairs[face.index()]
    }

    /// Returns the number of the pair of `face` that contains the crossing of `edge`.
    pub fn pair_of(&self, face: Face, edge: Edge) -> Option<usize> {
        self.pairs(face).iter().position(|p| p.edges.contains(&edge))
    }

    /// Whether a wall separates the sheet through the crossing of `edge` from the cell's other
    /// sheets.
    pub fn is_walled_cap(&self, edge: Edge) -> bool {
        self.has_several_sheets() && self.sheets[self.sheet_of(edge) as usize].kind != SheetKind::Main
    }
}

/// Returns the pairs of one face.
fn face_pairs(face: Face, mask: u8, choice: FaceChoice) -> Vec<Pair> {
    let (corners, edges) = (face.corners(), face.edges());
    let inside = corners.map(|c| mask & c.bit() != 0);
    let crossed = |i: usize| inside[i % 4] != inside[(i + 1) % 4];
    let around_outside = choice.0 & face.bit() != 0;
    // Corner i lies between edges i - 1 and i.
    let around = |i: usize| Pair { edges: [edges[(i + 3) % 4], edges[i]], around: Some(corners[i]) };
    match (0..4).filter(|&i| crossed(i)).count() {
        0 => Vec::new(),
        2 => match (0..4).find(|&i| crossed(i + 3) && crossed(i)) {
            Some(i) => vec![around(i)],
            None => {
                let first = usize::from(!crossed(0));
                vec![Pair { edges: [edges[first], edges[first + 2]], around: None }]
            }
        },
        _ => (0..4).filter(|&i| inside[i] != around_outside).map(around).collect(),
    }
}

fn kind(edges: EdgeSet) -> SheetKind {
    if let Some(corner) = Corner::all().find(|c| c.edges() == edges) {
        return SheetKind::CornerCap(corner);
    }
    match Edge::all().find(|e| e.adjacent() == edges) {
        Some(edge) => SheetKind::EdgeCap(edge),
        None => SheetKind::Main,
    }
}

/// The number of a row of the [`CaseTable`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, bytemuck::Zeroable)]
pub struct CaseId(u16);

/// The cases of all masks of inside corners, with all choices for their ambiguous faces.
#[derive(Debug)]
pub struct CaseTable {
    rows: Vec<Case>,
    /// The first row and the ambiguous faces of each mask. The choice, packed to those faces,
    /// counts from that row.
    masks: [(u16, u8); 256],
}

/// The two masks without an edge of one sign.
///
/// Their faces are always joined around the inside corners. A checkerboard with two opposite faces
/// joined one way and four the other has two sheets of six crossings that no plane separates.
const CHECKERBOARDS: [u8; 2] = [0x69, 0x96];

impl CaseTable {
    /// Returns the table, built at the first call.
    pub fn get() -> &'static CaseTable {
        static TABLE: LazyLock<CaseTable> = LazyLock::new(CaseTable::build);
        &TABLE
    }

    fn build() -> CaseTable {
        let mut rows = Vec::new();
        let masks = std::array::from_fn(|mask| {
            let mask = mask as u8;
            let first = rows.len() as u16;
            let plain = Case::new(mask, FaceChoice::INSIDE_APART);
            let faces = if CHECKERBOARDS.contains(&mask) { 0 } else { plain.ambiguous };
            for packed in 0..1u8 << faces.count_ones() {
                rows.push(Case::new(mask, FaceChoice::from_bits(unpack(packed, faces))));
            }
            (first, faces)
        });
        CaseTable { rows, masks }
    }

    /// Returns the row of a mask of inside corners, bit i for corner i, with a choice for its
    /// ambiguous faces.
    #[inline]
    pub fn id(&self, mask: u8, choice: FaceChoice) -> CaseId {
        let (first, faces) = self.masks[mask as usize];
        CaseId(first + if choice.0 & faces == 0 { 0 } else { u16::from(pack(choice.0, faces)) })
    }

    /// Returns the row with number `id`.
    #[inline]
    pub fn case(&self, id: CaseId) -> &Case {
        &self.rows[id.0 as usize]
    }
}

/// Spreads the low bits of `packed` to the set bits of `to`.
fn unpack(packed: u8, to: u8) -> u8 {
    let set = (0..8).filter(|i| to >> i & 1 == 1);
    set.enumerate().fold(0, |bits, (n, bit)| bits | (packed >> n & 1) << bit)
}

/// Gathers the bits of `bits` at the set bits of `from`: the inverse of [`unpack`].
fn pack(bits: u8, from: u8) -> u8 {
    let set = (0..8).filter(|i| from >> i & 1 == 1);
    set.enumerate().fold(0, |packed, (n, bit)| packed | (bits >> bit & 1) << n)
}

#[cfg(test)]
mod tests;
