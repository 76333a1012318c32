//! The recipe: from a mesh and a distance to the offset surface and its narrow band.
//!
//! ```text
//!  mesh -> hierarchy -> signed distance -> filters -> band -> edges -> contour -> mesh
//!                                                       `-> OpenVDB, where the band is kept
//! ```
//!
//! Promised for a closed, consistently oriented input: the result is closed, 2-manifold,
//! consistently oriented and free of self-intersections, on the coordinates of the chosen
//! [`Precision`](crate::Precision); the same bytes for every number of threads.

mod error;
mod job;
mod memory;
mod partition;
mod pipeline;
mod prepared;
mod result;
mod settings;
mod stages;
mod statistics;
#[cfg(feature = "openvdb")]
mod stored_band;
#[cfg(not(feature = "openvdb"))]
#[path = "stored_band_absent.rs"]
mod stored_band;
mod stream;
mod surface;
#[cfg(test)]
mod tests;
mod voxel_refinement;

pub use error::{EmptyResult, InputError, MemoryError, OffsetError};
pub use job::job;
pub use pipeline::offset;
#[cfg(feature = "openvdb")]
pub use pipeline::offset_band;
#[cfg(feature = "openvdb")]
pub use result::BandResult;
pub use result::{OffsetResult, StreamResult};
#[cfg(feature = "openvdb")]
pub use settings::BandOptions;
pub use settings::{OffsetSettings, OpenInput, SettingsError};
pub use statistics::{EngineTimes, OffsetStatistics, VdbStatistics};
pub use stream::{MeshSink, Partition, offset_streamed};
