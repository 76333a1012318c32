//! Candidate lists: the triangles that can be closest to any point of a block, narrowed down the octree.
//!
//! Nodes and edges that are near each other ask the same triangles. A leaf of the band collects once, from the
//! hierarchy, those that matter anywhere in it; its halves and quarters keep what matters to them:
//!
//! ```text
//!  hierarchy -> 8^3 nodes -> 4^3 -> 2^3 -> eight nodes at a time, and the edges that start at them
//! ```
//!
//! What is dropped is decided by conservative bounds in f32; what is left is evaluated in f64, by the same
//! arithmetic as a query of the hierarchy. So a list names the same closest triangle as the hierarchy does, for every
//! point of its block.
//!
//! The rule: with q any point of the mesh, a triangle T whose distance from every corner of a box is at least the
//! corner's distance from q is no nearer than q anywhere in the box. For d(x, T)^2 - |x - q|^2 is, with |x|^2
//! cancelling, the least of functions that are linear in x, one for each point of T; so it is concave, and least at a
//! corner.

mod triangle_f32;
mod lists;
mod pruner;
mod bounded_list;
mod closest_to_nodes;
#[cfg(test)]
mod tests;

pub use bounded_list::{Candidates, PlaneBound};
pub use lists::{BlockLists, CandidateLists, block_in_leaf};
pub use pruner::{CandidatePruner, Nearest};
pub use triangle_f32::EightPoints;
