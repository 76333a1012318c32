//! Triangle meshes: the type, its clean-up, its topology, its measures, and generated models.

mod tri_mesh;

pub use tri_mesh::TriMesh;
