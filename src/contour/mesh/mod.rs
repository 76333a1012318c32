//! The mesh leaf by leaf: triangles written where they stay, and the order in which it is handed out.

mod changes;
mod compact;
mod leaf_order;
mod triangle_slots;

pub use changes::{Changes, NEW_TRIANGLE, NEW_VERTEX};
pub use leaf_order::VertexRun;
pub use triangle_slots::{Slots, Triangles};
