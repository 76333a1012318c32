//! What the lattice cannot see: parts of the offset surface that cross no grid edge, or one edge twice.
//!
//! A sheet thinner than a voxel, a gap narrower than one and a part smaller than a cell leave no sign change behind, and
//! the contour knows nothing of them. The distance field does. Where the triangles that are closest to the corners of a
//! cell face away from each other, the field is searched between them:
//!
//! ```text
//!   nodes that disagree -> edges and cells between them -> points with the other sign -> not in the mesh? -> places
//!       directions               suspects                                                 confirm           places
//! ```
//!
//! Promised: every place is a point whose true sign differs from the result's, by more than 0.05
//! voxels. Not promised: to find all. What is thinner than a few hundredths of a voxel, or hides where only one wall is
//! within a voxel of any node, can be missed.

mod confirm;
mod directions;
mod places;
mod suspects;
#[cfg(test)]
mod tests;

pub use confirm::lost;
pub use places::{Place, Unseen, UnseenKind};
pub use suspects::{Suspects, suspects};
