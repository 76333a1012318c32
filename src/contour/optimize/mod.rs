//! Edits of the finished mesh: features recovered outside of their cells, and a tolerance kept.

mod collapse;
mod distance_cache;
mod feature_recovery;
mod optimizer;
mod patch;
mod schedule;
mod tolerance;

pub use feature_recovery::{RECOVERY_PASSES, recover};
pub use schedule::{BORDER_LEAVES, MAX_TRIANGLE_REACH};
pub use tolerance::{TOLERANCE_PASSES, refine};
