//! The narrow band in OpenVDB: grids in memory and `.vdb` files.
//!
//! A [`SurfaceGrid`] is a level set that other programs accept: a `FloatGrid` named `surface`,
//! class level set, whose transform is the lattice's (world = h * index, no offset), with
//!
//! ```text
//!  active voxels    exactly those with abs(phi) < background
//!  inactive values  exactly +background (outside) or -background (inside), in leaves and tiles
//!  background       a hair above half width * h: checkLevelSet wants 3 h at least, whoever rounds
//! ```
//!
//! phi is in model units, negative inside, and never 0. [`SurfaceGrid::check_level_set`] runs
//! OpenVDB's own nine tests. A [`ClosestGrid`] of the same leaves holds the ids of the closest
//! triangles, where they were asked for.
//!
//! Leaves go in and out in batches, as flat slices; [`Band::save`] and [`Band::open`] are the
//! files. The same grids and options give the same bytes.
//!
//! Truncated files are recognised whoever wrote them. Damaged ones are if they were written here:
//! their identifier is a hash of the content. Not promised is what happens with another program's
//! damaged file: the format has no check sums, and OpenVDB trusts what it reads.

mod band_file;
mod bridge;
mod error;
pub(crate) mod file;
mod grid;
pub(crate) mod info;
mod leaves;
#[cfg(feature = "cli")]
pub(crate) mod openvdb_tools;
mod content_id;
pub(crate) mod tiles;

pub use crate::lattice::{Ijk, Lattice, LeafMask};
pub use error::VdbError;
pub use file::{Compression, MetaValue, VdbOptions, VdbPrecision};
pub use grid::{Band, ClosestGrid, SurfaceGrid};
pub use info::FileInfo;
pub use tiles::merge_bands;
