//! The solid on a lattice: nodes inside (\[WC13\] section 3), and crossings of edges with its
//! boundary.

pub(super) mod crossings;
mod dilate;
pub(super) mod edge_search;
pub(super) mod nodes;
mod one_sided;
pub(super) mod region;
pub(super) mod vertex_pillars;
