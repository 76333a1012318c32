//! The solid on a lattice: which nodes are inside (\[WC13\] section 3) and where edges leave it.

pub(super) mod crossings;
mod dilate;
pub(super) mod edge_search;
pub(super) mod nodes;
mod one_sided;
pub(super) mod region;
pub(super) mod vertex_pillars;
