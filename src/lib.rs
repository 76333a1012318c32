//! exocarp: offset surfaces of triangle meshes.

pub mod error;
pub mod run;

pub mod band;
pub mod contour;
pub mod edge;
pub mod geom;
pub mod io;
pub mod mesh;
pub mod offset;
pub mod vdb;
