//! Thickening: the solid on one side of an open surface patch (\[WC13\], Wang and Chen 2013).
//!
//! ```text
//!  patch -> hierarchy -> nodes -> crossings -> contour without its inset
//!        -> strips to the patch -> shape processing, exact tests -> mesh
//! ```
//!
//! | files | step |
//! |---|---|
//! | `pipeline`, `attempt` | the whole, and one attempt on one lattice |
//! | `patch/` | boundary loops and narrow holes of the patch, its exact test |
//! | `solid/` | nodes in the solid, crossings of lattice edges with its boundary |
//! | `stitch/` | contour without its inset, strips between the boundary and the rims |
//! | `finish/` | shape processing, each move tested exactly |
//! | `closed_shell` | the shell of a closed patch, by an offset |
//!
//! Words: S is the patch, r the thickness. The *shell* is the surface at distance r from S, the
//! *inset* the one half a voxel below S. The *section* stands on the boundary of S. A *rim* is a
//! boundary loop of section and shell once the inset is left out. A *strip* of triangles joins a
//! rim to a boundary loop of S. A *cap* closes a narrow hole or a small rim.
//!
//! Promised: the result is closed, 2-manifold, consistently oriented and free of
//! self-intersections, on the coordinates of the chosen [`Precision`](crate::contour::Precision).
//! Every triangle of the patch is in it. Where that cannot be had, the run fails and says where.
//! docs/thicken.md has the argument.

mod attempt;
mod closed_shell;
mod error;
mod finish;
mod memory_estimate;
mod outcome;
mod patch;
mod pipeline;
mod settings;
mod solid;
mod statistics;
mod stitch;
#[cfg(test)]
mod tests;

pub use error::{Obstacle, PatchError, ThickenError, ThickenSettingsError};
pub use pipeline::{ThickenResult, thicken};
pub use settings::{PatchSide, SectionNormals, ThickenSettings};
pub use statistics::{ShapeCounts, ThickenStatistics, ThickenTimes, TriangleCounts};
