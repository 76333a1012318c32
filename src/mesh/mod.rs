//! Triangle meshes: the type, its clean-up, its topology, its measures, and generated models.

pub mod measure;
pub mod shapes;
mod tri_mesh;

pub use tri_mesh::TriMesh;
