//! The band in OpenVDB and its files: what goes in comes out, and other programs accept it.

mod files;
mod grids;
mod offsets;
mod needs_python;
mod sphere;
