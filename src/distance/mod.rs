//! Signed distance to a mesh: closest point by the hierarchy, sign by the angle-weighted
//! pseudonormal (Baerentzen and Aanaes 2005).

mod depth;
mod pseudonormal;
mod signed;
#[cfg(test)]
mod tests;

pub use depth::{Depth, largest_depth};
pub use signed::{Sample, SignedDistance};
