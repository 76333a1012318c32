//! Sub-voxel features: parts of the offset surface that cross no grid edge, or one edge twice.
//!
//! A sheet thinner than a voxel, a gap narrower than a voxel and a part smaller than a cell leave
//! no sign change behind. The contour knows nothing of them; the distance field does. Where the
//! triangles that are closest to the corners of a cell face away from each other, the field is
//! searched between the corners:
//!
//! ```text
//!   nodes that disagree -> points with the other sign -> on the mesh's wrong side? -> features
//!        directions                  search                        confirm            features
//! ```
//!
//! Promised: every feature holds a point whose true sign differs from the result's, by more than
//! 0.05 voxels. Not promised: that all features are found. A feature that is thinner than a few
//! hundredths of a voxel can go unnoticed, and so can one where only one wall is within a voxel of
//! any node.

mod confirm;
mod directions;
mod features;
mod search;
#[cfg(test)]
mod tests;

pub use confirm::confirm_missed;
pub use features::{MissedFeature, MissedFeatures, MissedKind};
pub use search::{MissedCandidates, find_missed};
