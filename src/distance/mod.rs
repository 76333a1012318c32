//! Signed distance to a mesh: closest point by the hierarchy, sign by the angle-weighted pseudonormal
//! (Baerentzen and Aanaes 2005).

mod pseudonormal;
mod signed;
#[cfg(test)]
mod tests;

pub use signed::{Sample, SignedDistance};
