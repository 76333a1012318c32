//! Intersections of grid edges with the offset surface (\[LW11\] section V).
//!
//! Promised for closed input: every crossing lies within 1e-6 voxels of the offset surface.

mod analytic;
mod bisection;
mod crossings;
mod triangle_iteration;
mod hybrid;
mod leaf;
mod regions;
mod settings;
mod shared;
mod solve;
mod statistics;

pub use crossings::{Crossing, Crossings, EdgeId, EdgeNumbers, TooManyEdges};
pub use settings::{EdgeSettings, RootMethod};
pub use solve::{solve, solve_by};
pub use statistics::EdgeStatistics;
