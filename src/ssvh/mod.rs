//! Swept sphere volume hierarchy over the triangles of a mesh (\[LW11\] section IV.A, Larsen et al.
//! 2000).
//!
//! A tree with eight children per node. Every child lane, inner node or single triangle, carries
//! the best fitting of a point-, line- or rectangle-swept sphere in f32, conservatively rounded;
//! eight lanes are bounded at once. Triangles that survive are evaluated in f64, and that
//! evaluation alone decides.
//!
//! Promised: the closest triangle is the one with the smallest computed squared distance, the
//! lowest triangle number on a tie, the same as brute force finds with the same arithmetic,
//! whatever the query starts from.

mod build;
mod collect;
mod nearest;
mod node;
mod query;
mod slot;
#[cfg(test)]
mod tests;
mod validate;

pub use build::Ssvh;
pub use nearest::Closest8;
pub use query::Hit;
pub use slot::TriangleSlot;
pub use validate::InvalidSsvh;
