//! exocarp: offset surfaces of triangle meshes.

pub mod error;
pub mod geom;
pub mod lattice;
pub mod run;

pub mod band;
pub mod contour;
pub mod distance;
pub mod edge;
pub mod filter;
pub mod io;
pub mod mesh;
pub mod offset;
pub mod ssvh;
pub mod vdb;
