//! A lattice cell by itself: corners, edges and faces, the way of the contour through it, and its number.

mod active_cells;
mod case_table;
mod topology;

pub use active_cells::{CellId, CellNumbers, CornerSigns, constant_case, locate};
pub use case_table::{Case, CaseId, CaseTable, MAX_SHEETS, Pair, SheetKind};
pub use topology::{Corner, Edge, EdgeSet, Face};

#[cfg(test)]
pub use case_table::FaceChoice;
