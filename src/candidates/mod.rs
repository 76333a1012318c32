//! Candidate lists: the triangles that can be closest to any point of a block.
//!
//! Nodes and edges that are near each other ask the same triangles. A leaf of the band collects
//! once, from the hierarchy, the triangles that matter anywhere in it. Its octants, and their
//! octants, keep the triangles that matter to them:
//!
//! ```text
//!  hierarchy -> 8^3 nodes -> 4^3 -> 2^3 -> eight nodes at a time, and the edges that start at them
//!                 |           pruner     |       closest_to_nodes
//!            triangle_f32                `-> lists, bounded_list
//! ```
//!
//! Conservative bounds in f32 decide what is dropped. What is left is evaluated in f64, by the same
//! arithmetic as a query of the hierarchy. So a list names the same closest triangle as the
//! hierarchy does, for every point of its block.
//!
//! The rule: let q be any point of the mesh. A triangle T whose distance from every corner of a box
//! is at least the corner's distance from q is no nearer than q anywhere in the box. Proof: in d(x,
//! T)^2 - |x - q|^2 the term |x|^2 cancels, so the difference is the least of functions that are
//! linear in x, one for each point of T. It is concave, and least at a corner.

mod triangle_f32;
mod pruner;
mod closest_to_nodes;
mod bounded_list;
mod lists;
#[cfg(test)]
mod tests;

pub use bounded_list::{Candidates, PlaneBound};
pub use lists::{BlockLists, CandidateLists, block_in_leaf};
pub use pruner::{CandidatePruner, NearestCandidate};
pub use triangle_f32::EightPoints;
