//! A lattice cell by itself: its corners, edges and faces, how the contour runs through it, and which cells are active.

mod active_cells;
mod case_table;
mod topology;

pub use active_cells::{CellId, CellNumbers, CornerSigns, constant_case, locate};
#[cfg(test)]
pub use case_table::FaceChoice;
pub use case_table::{Case, CaseId, CaseTable, MAX_SHEETS, Pair, SheetKind};
pub use topology::{Corner, Edge, EdgeSet, Face};
