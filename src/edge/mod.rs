//! Intersections of grid edges with the offset surface (\[LW11\] section V).
//!
//! ```text
//!  solve -> leaf_edges -> triangle_iteration -> closed_form -> triangle_regions      crossings
//!                              | no root           ^ Remarks 5, 6, 7
//!                              `-> hybrid -> shared_triangle
//! ```
//!
//! Promised for closed input: every crossing lies within 1e-6 voxels of the offset surface.

mod settings;
mod statistics;
mod crossings;
mod solve;
mod leaf_edges;
mod triangle_iteration;
mod hybrid;
mod shared_triangle;
mod closed_form;
mod triangle_regions;
mod bisection;

pub use crossings::{Crossing, Crossings, EdgeId, EdgeNumbers};
pub use settings::{EdgeSettings, RootMethod};
pub use solve::{solve, solve_by};
pub use statistics::EdgeStatistics;
