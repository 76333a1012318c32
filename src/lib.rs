//! exocarp: offset surfaces of triangle meshes.

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr, clippy::too_many_lines)
)]

pub mod error;
pub mod geom;
pub mod run;
pub mod quantity;
pub mod system;

pub mod lattice;
pub mod mesh;
pub mod io;
pub mod ssvh;
pub mod distance;
pub mod filter;
pub mod candidates;
pub mod band;
#[cfg(feature = "openvdb")]
pub mod vdb;
pub mod edge;
pub mod subvoxel;
pub mod contour;
pub mod offset;
pub mod verify;
pub mod thicken;
#[cfg(feature = "cli")]
pub mod compare;
#[cfg(feature = "cli")]
pub mod paper;

pub use contour::ContourStatistics;
pub use error::Error;
#[cfg(feature = "openvdb")]
pub use offset::BandOptions;
pub use offset::{OffsetSettings, job};
pub use quantity::{Length, ParseQuantityError, Precision, TileIndex, Tolerance, VoxelSize};
pub use subvoxel::MissedFeatures;

#[doc(hidden)]
pub mod internals;

/// The README's example runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
