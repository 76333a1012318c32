//! Changes of the finished mesh: features recovered, and a tolerance kept, by edits that an exact test allows.

mod collapse;
mod distance_cache;
mod feature_recovery;
mod optimizer;
mod patch;
mod schedule;
mod tolerance;

pub use feature_recovery::{STAGES as RECOVERY_STAGES, recover};
pub use schedule::{BORDER_LEAVES, MAX_TRIANGLE_REACH};
pub use tolerance::{STAGES as TOLERANCE_STAGES, refine};
