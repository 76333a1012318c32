//! Triangle meshes: the type, its clean-up, its topology, its measures, and generated models.

mod chunk;
mod clean;
mod degenerate;
pub mod measure;
pub mod shapes;
mod topology;
mod equal;
mod tri_mesh;
mod usable;

pub use chunk::MeshChunk;
pub use clean::{CleanReport, clean, weld};
pub use topology::{Defects, Topology};
pub use tri_mesh::TriMesh;
pub use usable::{LENGTHS, MeshError};
