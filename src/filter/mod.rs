//! The filters that keep distance computations to the neighbourhood of the offset surface (\[LW11\]
//! section IV): bounding box, signed distance, octree. The fourth, the swept sphere volume
//! hierarchy, is a room of its own.
//!
//! A rejected block is not only empty: since abs(phi) at its centre exceeds its reach, the sign of
//! every node in it is known. So the inside of the whole grid follows without flood filling.

mod block;
mod bounding_box;
mod octree;
mod settings;
mod signed_distance;
mod statistics;

pub use block::Block;
pub use octree::{Filter, Verdict};
pub use settings::{BoxSide, BoxSideError, FilterSettings, MAX_BOX_EXPONENT, Switch};
pub use statistics::FilterStatistics;
