//! Triangle meshes: the type, its clean-up, its topology, its measures, and generated models.

mod clean;
mod equal;
mod tri_mesh;

pub use clean::{CleanReport, clean};
pub use tri_mesh::TriMesh;
