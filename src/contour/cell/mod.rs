//! A lattice cell by itself: corners, edges and faces, the way of the contour through it, and its
//! number.

mod active_cells;
mod case_table;
mod corner_signs;
mod topology;

pub use active_cells::{CellId, CellNumbers, constant_case, locate};
pub use case_table::{Case, CaseId, CaseTable, MAX_SHEETS, Pair, SheetKind};
pub use corner_signs::CornerSigns;
pub use topology::{Corner, Edge, EdgeSet, Face};

#[cfg(test)]
pub use case_table::FaceChoice;
