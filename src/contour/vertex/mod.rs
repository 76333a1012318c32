//! The vertices: of each sheet within its cell, and of faces where a connection would get in another sheet's way.

mod cell_vertex;
mod cells;
mod face_vertex;
mod feasible_region;
mod leaf_crossings;
mod leaf_vertices;
mod qef_batch;

pub use cell_vertex::is_missing;
pub use cells::{CellCase, Cells, Placements, split};
pub use face_vertex::{FaceVertices, face_vertices};
