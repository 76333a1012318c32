//! exocarp makes offset surfaces of triangle meshes: all points at one signed distance from a
//! model, as a new mesh, as a level set, or both.
//!
//! ```text
//!            model                      grown by r                   shrunk by r
//!                                       .------------.
//!         +--------+                   /              \
//!         |        |                  |                |                +----+
//!         |    +---+                  |         _______/                |    |
//!         |    |                      |        |                        +----+
//!         +----+                       \______/
//!
//!    closed, oriented        convex edges become round,     concave edges become round,
//!                            concave ones stay sharp        convex ones stay sharp
//! ```
//!
//! # An offset
//!
//! A [`TriMesh`] and a distance go in; [`offset`](offset()) returns the surface.
//!
//! ```
//! use exocarp::{Length, OffsetSettings, RunSettings, VoxelSize, offset, shapes};
//!
//! # fn main() -> Result<(), exocarp::Error> {
//! let model = shapes::carved_cube(8); // or TriMesh::load("part.stl")?
//! let settings = OffsetSettings {
//!     distance: Length::DiagonalFraction(0.02), // negative shrinks, 0 remeshes
//!     voxel: VoxelSize::Resolution(48),
//!     ..OffsetSettings::default()
//! };
//! let result = offset(&model, &settings, &RunSettings::default())?;
//! assert!(result.mesh.signed_volume() > model.signed_volume());
//! # let folder = std::env::temp_dir();
//! result.save(folder.join("grown.ply"))?;
//! # std::fs::remove_file(folder.join("grown.ply")).unwrap();
//! # Ok(())
//! # }
//! ```
//!
//! # What is promised, and what is not
//!
//! For a closed and consistently oriented input, at any distance and voxel size:
//!
//! - the result is closed, 2-manifold, consistently oriented, and no two of its triangles
//!   intersect, on the coordinates of the chosen [`Precision`];
//! - creases and corners are those of the true offset surface wherever an exact test finds room
//!   for them;
//! - the bytes are the same for every number of threads, and for a result at once, in slabs or in
//!   tiles;
//! - user data never panics: what cannot be used is an error that says why and what to do.
//!
//! Not promised: parts, sheets and gaps thinner than a voxel (those that the distance field shows
//! are named in [`OffsetStatistics`]), and anything about inside and outside of an open input far
//! from its surface.
//!
//! # A band
//!
//! [`offset_band`] makes the signed distance to the offset surface as an OpenVDB level set, and no
//! mesh. [`OffsetSettings::band`] keeps it beside a mesh.
//!
//! ```
//! # #[cfg(feature = "openvdb")]
//! # fn main() -> Result<(), exocarp::Error> {
//! use exocarp::vdb::VdbOptions;
//! use exocarp::{BandOptions, OffsetSettings, RunSettings, VoxelSize, offset_band, shapes};
//!
//! let settings = OffsetSettings {
//!     voxel: VoxelSize::Resolution(32),
//!     band: Some(BandOptions { half_width: 3.0, closest: false }),
//!     ..OffsetSettings::default()
//! };
//! let result = offset_band(&shapes::carved_cube(4), &settings, &RunSettings::default())?;
//! assert!(result.band.surface.active_voxels() > 0);
//! # let path = std::env::temp_dir().join("exocarp-tour.vdb");
//! result.band.save(&path, &VdbOptions::default())?;
//! # std::fs::remove_file(path).unwrap();
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "openvdb"))]
//! # fn main() {}
//! ```
//!
//! # Larger than memory
//!
//! [`offset_streamed`] works off the lattice slab by slab and hands the mesh on chunk by chunk: to
//! a file ([`io::MeshStream`]), or to any [`MeshSink`].
//!
//! # Thickening
//!
//! [`thicken`](thicken()) makes a solid of an open patch, with every triangle of the patch on its
//! boundary.
//!
//! ```
//! use exocarp::{Length, RunSettings, ThickenSettings, shapes, thicken};
//!
//! # fn main() -> Result<(), exocarp::Error> {
//! let patch = shapes::wave(4);
//! let thickness = Length::DiagonalFraction(0.1);
//! let settings = ThickenSettings { thickness, ..ThickenSettings::default() };
//! let solid = thicken(&patch, &settings, &RunSettings::default())?.mesh;
//! assert_eq!(solid.triangles[..patch.triangles.len()], patch.triangles);
//! # Ok(())
//! # }
//! ```
//!
//! # Judging a mesh
//!
//! [`verify`](mod@verify) judges a mesh from any program as the offset of another: topology and
//! intersections exactly, errors and what is missing by samples.
//!
//! ```
//! use exocarp::verify::{VerifySettings, verify};
//! use exocarp::{Length, OffsetSettings, RunSettings, VoxelSize, offset, shapes};
//!
//! # fn main() -> Result<(), exocarp::Error> {
//! let run = RunSettings::default();
//! let (model, distance) = (shapes::sphere(4), Length::Units(0.1));
//! let voxel = VoxelSize::Resolution(24);
//! let settings = OffsetSettings { distance, voxel, ..OffsetSettings::default() };
//! let grown = offset(&model, &settings, &run)?.mesh;
//! let judged_by = VerifySettings { distance, samples: 1000, ..VerifySettings::default() };
//! assert!(verify(&model, &grown, &judged_by, &run)?.broken.is_empty());
//! # Ok(())
//! # }
//! ```
//!
//! # Errors
//!
//! Each operation has an error of its own, with a variant for each cause; [`Error`] takes them all,
//! for `?`. Each is one sentence with the culprit and the remedy.
//!
//! ```
//! use exocarp::{InputError, OffsetError, OffsetSettings, RunSettings, offset, shapes};
//!
//! let open = shapes::wave(4);
//! match offset(&open, &OffsetSettings::default(), &RunSettings::default()) {
//!     Err(OffsetError::Input(InputError::Open { count, .. })) => assert!(count > 0),
//!     other => panic!("{other:?}"),
//! }
//! ```
//!
//! # Cancelling and progress
//!
//! [`RunSettings`] says how a computation runs, never what it computes: threads, a [`CancelToken`]
//! for a button or a signal, and a receiver of [`Progress`].
//!
//! ```
//! use exocarp::{CancelToken, OffsetError, OffsetSettings, Phase, Progress, RunSettings};
//! use exocarp::{offset, shapes};
//! use std::sync::Arc;
//!
//! /// Cancels when the band begins.
//! struct Impatient(CancelToken);
//!
//! impl Progress for Impatient {
//!     fn begin(&self, phase: Phase, _steps: u64) {
//!         if phase == Phase::Band {
//!             self.0.cancel();
//!         }
//!     }
//!     fn advance(&self, _phase: Phase, _done: u64) {}
//!     fn end(&self, _phase: Phase) {}
//! }
//!
//! let cancel = CancelToken::default();
//! let progress = Arc::new(Impatient(cancel.clone()));
//! let run = RunSettings::default().with_cancel(cancel).with_progress(progress);
//! let result = offset(&shapes::carved_cube(8), &OffsetSettings::default(), &run);
//! assert!(matches!(result, Err(OffsetError::Cancelled)));
//! ```
//!
//! # Threads, types and features
//!
//! Settings and results are `Send` and `Sync`.
//!
//! | feature | what it adds |
//! |---|---|
//! | `openvdb` (default) | bands, and the module `vdb`; needs OpenVDB and a C++ compiler |
//! | `cli` (default) | the program; a library needs none of it |
//! | `serde` | `Serialize` and `Deserialize` for settings, `Serialize` for reports |

#![cfg_attr(
    not(test),
    warn(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr, clippy::too_many_lines)
)]

mod run;
mod quantity;
mod geom;
mod system;

mod lattice;
mod mesh;
pub mod io;
mod ssvh;
mod distance;
mod filter;
mod candidates;
mod band;
#[cfg(feature = "openvdb")]
pub mod vdb;
mod edge;
mod subvoxel;
mod contour;
mod offset;
pub mod verify;
mod thicken;
#[cfg(feature = "cli")]
mod compare;
#[cfg(feature = "cli")]
mod paper;

mod error;

#[doc(hidden)]
pub mod internals;

pub use error::Error;
pub use lattice::LatticeError;
pub use mesh::{CleanReport, MeshChunk, MeshError, TriMesh, clean, shapes};
#[cfg(feature = "openvdb")]
pub use offset::{BandOptions, BandResult, offset_band};
pub use offset::{
    EmptyResult, InputError, MemoryError, MeshSink, OffsetError, OffsetResult, OffsetSettings,
    OffsetStatistics, OpenInput, Partition, SettingsError, StreamResult, offset, offset_streamed,
};
pub use quantity::{Length, ParseQuantityError, Precision, TileIndex, Tolerance, VoxelSize};
pub use run::{CancelToken, Cancelled, Phase, Progress, RunSettings, ThreadError};
pub use subvoxel::MissedFeatures;
pub use thicken::{
    Obstacle, PatchError, PatchSide, SectionNormals, ThickenError, ThickenResult, ThickenSettings,
    ThickenSettingsError, thicken,
};

// Fails to compile when a type loses `Send` or `Sync`.
const _: fn() = || {
    fn assert_send_sync<T: Send + Sync>() {}
    assert_send_sync::<TriMesh>();
    assert_send_sync::<OffsetSettings>();
    assert_send_sync::<OffsetResult>();
    #[cfg(feature = "openvdb")]
    assert_send_sync::<BandResult>();
    assert_send_sync::<StreamResult>();
    assert_send_sync::<ThickenSettings>();
    assert_send_sync::<ThickenResult>();
    assert_send_sync::<verify::VerifyReport>();
    assert_send_sync::<RunSettings>();
    assert_send_sync::<Error>();
};

/// The README's example runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
