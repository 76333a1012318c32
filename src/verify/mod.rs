//! The judge: whether a mesh is the offset surface that it is said to be.
//!
//! ```text
//!  OUTPUT -> weld -> topology
//!                 -> box tree -> intersections
//!  INPUT, OUTPUT  -> distance    from OUTPUT to the true offset surface
//!                 -> missing     distance from the true offset surface to OUTPUT
//!                 -> creases     the share of the true offset surface's creases that OUTPUT has
//!                 -> shell       the wall between two sheets
//!  all            -> report      and the promises that are broken
//! ```
//!
//! OUTPUT may come from any program. Topology and intersections are exact on the coordinates as
//! they are given. The other figures are taken at samples, which depend on the seed alone: a report
//! is the same for every number of threads.

mod case;
mod creases;
mod distance_error;
mod error;
mod input_edges;
mod intersections;
pub(crate) mod judge;
mod missing;
mod promises;
pub(crate) mod report;
mod sampling;
pub(crate) mod settings;
mod shell;
#[cfg(test)]
pub(crate) mod tests;
mod topology;
mod welded;

pub use error::{MeshRole, VerifyError};
pub use judge::{soundness, verify};
pub use report::{
    BrokenPromise, CreaseReport, DistanceReport, IntersectionReport, MissingReport, Promise, ShellReport,
    Soundness, TopologyReport, VerifyReport,
};
pub use settings::{Subject, VerifySettings};
