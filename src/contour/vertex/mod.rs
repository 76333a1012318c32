//! The vertices: one for each sheet, within its cell, and one on each face where a connection would
//! get in another sheet's way.

mod cell_vertex;
mod cells;
mod context;
mod face_vertex;
mod feasible_region;
mod leaf_crossings;
mod leaf_vertices;
mod place;
mod qef_batch;
mod relocation;

pub use cell_vertex::is_missing;
pub use cells::{CellCase, Cells};
pub use context::CellContext;
pub use face_vertex::FaceVertices;
pub use place::{PlacedVertices, with_vertices};
pub use relocation::Relocation;
