//! The mesh by leaves: buffers of triangles, changes, and the order in which the mesh is handed
//! out.

mod changes;
mod compact;
mod leaf_mesh;
mod leaf_order;
mod triangle_slots;

pub use changes::{Changes, NEW_TRIANGLE, NEW_VERTEX};
pub use compact::split_slices;
pub use leaf_mesh::{AXIS_STRIDE, CHANGED, LeafMesh, VertexRun};
pub use triangle_slots::{TriangleBuffer, TriangleSlots};
