//! Vertices on faces between cells, where the segment between two cell vertices would leave the
//! part of the face that belongs to their pair of crossings.
//!
//! The segment between the vertices of two neighbouring cells meets their common face. Where the
//! contour passes a corner of the face beside another sheet (the face is ambiguous, or the pair
//! belongs to a cap in one of the cells), it must do so between the corner and the face's diagonal:
//!
//! ```text
//!    n2 ------- +         c:      the corner that the pair goes around
//!     | \   q   |         n1, n2: its neighbours on the face
//!     |p  \     |         p:      the segment passes in the corner's triangle: nothing to do
//!     |     \   |         q:      it does not: the pair gets a vertex at its middle
//!     c ------ n1
//! ```

use super::cell_vertex::is_missing;
use super::cells::Cells;
use crate::band::{LeafId, SignField};
use crate::contour::cell::{Case, CellId, CellNumbers, Corner, Edge, Face, Pair, locate};
use crate::contour::error::ContourError;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::edge::Crossings;
use crate::geom::predicates::orient3d;
use crate::lattice::{Axis, Ijk, LEAF_DIM, LatticeError, bits};
use crate::run::{Cancelled, RunSettings, SHARE};
use rayon::prelude::*;

/// The face vertices of an active cell, on its upper faces.
#[derive(Clone, Copy, Debug)]
struct Marks {
    cell: CellId,
    /// The number of face vertices of the leaf's cells before this one: at most 6 x 512.
    before: u16,
    /// Bit 2 axis + pair of each pair with a vertex.
    pairs: u8,
}

/// The face vertices of all cells, and their numbers.
#[derive(Debug)]
pub struct FaceVertices {
    /// The cells with face vertices, ascending: few of thousands.
    marks: Vec<Marks>,
    /// The number of the first face vertex of each leaf, and the number after the last at the end.
    first: Vec<u32>,
    /// The positions, in the order leaf, cell, axis, pair.
    pub positions: Vec<[f64; 3]>,
}

impl FaceVertices {
    /// Returns the numbers of the face vertices of a leaf.
    pub fn range(&self, leaf: LeafId) -> std::ops::Range<u32> {
        let n = leaf.0 as usize;
        self.first[n]..self.first[n + 1]
    }

    /// Returns the number of the face vertex between a cell of `leaf` and the next cell along
    /// `axis`, on the pair with the crossing of `edge`; `None` if there is none. `edge` is an edge
    /// of `cell`.
    #[inline]
    pub fn get(&self, leaf: LeafId, cell: CellId, case: &Case, axis: Axis, edge: Edge) -> Option<u32> {
        let marks = self.marks[self.marks.binary_search_by_key(&cell, |marks| marks.cell).ok()?];
        let bit = 2 * axis as usize + case.pair_of(Face::upper(axis), edge)?;
        if marks.pairs >> bit & 1 == 0 {
            return None;
        }
        let below = (marks.pairs & ((1 << bit) - 1)).count_ones();
        Some(self.first[leaf.0 as usize] + u32::from(marks.before) + below)
    }
}

/// Places a vertex on each pair that needs one, numbered on from the cell vertices `vertices`.
///
/// # Errors
/// When there are more than 2^32 - 1 vertices, or the run is cancelled.
pub fn face_vertices(
    cells: &Cells<'_>,
    vertices: &[[f64; 3]],
    run: &RunSettings,
) -> Result<FaceVertices, ContourError> {
    // Both cells at a face can need a vertex there.
    let upper = |leaf| Axis::ALL.map(|axis| cells.context.signs.neighbour(leaf, Ijk::default().next(axis).0));
    let may_need_vertex =
        |leaf| [Some(leaf)].iter().chain(&upper(leaf)).flatten().any(|&l| cells.maybe_ambiguous(l));
    let leaves: Vec<LeafId> = cells.context.numbers.leaves().filter(|&leaf| may_need_vertex(leaf)).collect();
    let per_leaf: Vec<(Vec<Marks>, Vec<[f64; 3]>)> = leaves
        .par_iter()
        .with_min_len(16)
        .with_max_len(SHARE)
        .map(|&leaf| {
            run.check()?;
            Ok(in_leaf(cells, vertices, leaf))
        })
        .collect::<Result<_, Cancelled>>()?;
    let first_of_all = vertices.len() as u64;
    let mut first = Vec::with_capacity(cells.context.signs.len() + 1);
    let (mut marks, mut positions) = (Vec::new(), Vec::new());
    let next = |positions: &Vec<_>| {
        u32::try_from(first_of_all + positions.len() as u64).map_err(|_| LatticeError::TooManyVertices)
    };
    for ((of_leaf, in_leaf), leaf) in per_leaf.into_iter().zip(leaves) {
        // For the leaves before that have none, too.
        first.resize(leaf.0 as usize + 1, next(&positions)?);
        marks.extend(of_leaf);
        positions.extend(in_leaf);
    }
    first.resize(cells.context.signs.len() + 1, next(&positions)?);
    Ok(FaceVertices { marks, first, positions })
}

/// Places the face vertices on the upper faces of the cells of one leaf.
fn in_leaf(cells: &Cells<'_>, vertices: &[[f64; 3]], leaf: LeafId) -> (Vec<Marks>, Vec<[f64; 3]>) {
    let (signs, numbers): (&SignField, &CellNumbers) = (cells.context.signs, cells.context.numbers);
    let (mut all, mut positions) = (Vec::new(), Vec::new());
    for number in bits(numbers.active(leaf)) {
        let local = Ijk::in_leaf(Ijk::default(), number);
        let cell = numbers.id(leaf, number);
        let case = cells.case(cell);
        let mut marks = Marks { cell, before: positions.len() as u16, pairs: 0 };
        for axis in Axis::ALL {
            let face = Face::upper(axis);
            let is_last = axis == Axis::X && local.0[0] == LEAF_DIM - 2 && signs.is_border(leaf, 1);
            if is_last || case.pairs(face).is_empty() {
                continue;
            }
            let (_, next) = numbers.locate(signs, leaf, local.next(axis).0);
            let next_case = cells.case(next);
            let ambiguous = case.is_ambiguous(face);
            if !(ambiguous || case.has_several_sheets() || next_case.has_several_sheets()) {
                continue;
            }
            for (n, pair) in case.pairs(face).iter().enumerate() {
                let Some(corner) = pair.around else { continue };
                let edge = pair.edges[0];
                let next_edge = across(edge, axis);
                if !(ambiguous || case.is_walled_cap(edge) || next_case.is_walled_cap(next_edge)) {
                    continue;
                }
                let ends = [
                    vertices[cells.vertex(cell, edge) as usize],
                    vertices[cells.vertex(next, next_edge) as usize],
                ];
                if ends.into_iter().any(is_missing) {
                    continue;
                }
                let ijk = signs.origin(leaf) + local;
                if !passes_corner(&cells.context.lattice, ijk, axis, corner, ends) {
                    marks.pairs |= 1 << (2 * axis as usize + n);
                    positions.push(middle(
                        &cells.context.lattice,
                        cells.context.crossings,
                        signs,
                        leaf,
                        local,
                        axis,
                        pair,
                    ));
                }
            }
        }
        if marks.pairs != 0 {
            all.push(marks);
        }
    }
    (all, positions)
}

/// Returns the edge of the next cell along `axis` that coincides with `edge` on the upper face
/// across `axis`.
fn across(edge: Edge, axis: Axis) -> Edge {
    edge.low().across(axis).edge(edge.axis())
}

/// Whether the segment between the vertices of `cell` and of the next cell along `axis` meets their
/// common face strictly between `corner` and the line through the corner's neighbours.
fn passes_corner(
    lattice: &RoundedLattice,
    cell: Ijk,
    axis: Axis,
    corner: Corner,
    ends: [[f64; 3]; 2],
) -> bool {
    let (u, v) = axis.others();
    let node = |c: Corner| lattice.node(cell + Ijk(c.offset()));
    let turn = orient3d(ends[0], ends[1], node(corner.across(u)), node(corner.across(v)));
    // For the corner at (0, 0) the segment, the line and the corner follow the right hand. Each
    // mirroring turns the sign around.
    if corner.position(u) == corner.position(v) { turn > 0.0 } else { turn < 0.0 }
}

/// Returns the middle of a pair on the upper face across `axis` of the cell `local`, exactly on the
/// rounded face.
fn middle(
    lattice: &RoundedLattice,
    crossings: &Crossings,
    signs: &SignField,
    leaf: LeafId,
    local: Ijk,
    axis: Axis,
    pair: &Pair,
) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for edge in pair.edges {
        let low = Ijk(edge.low().offset());
        let (at, number) = locate(signs, leaf, (local + low).0);
        let id = crossings.numbers.get(at, edge.axis(), number).expect("a pair joins crossed edges");
        let mut point = low.0.map(f64::from);
        point[edge.axis() as usize] = lattice.clamp_to_edge(crossings.sample(id).t);
        sum = std::array::from_fn(|i| sum[i] + point[i]);
    }
    let mut point = sum.map(|x| 0.5 * x);
    point[axis as usize] = 1.0;
    lattice.between_walls(signs.origin(leaf) + local, point)
}
