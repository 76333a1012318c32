//! The patch as it comes: its boundary loops, its holes, and exact tests against intersections.

pub(super) mod boundary;
pub(super) mod holes;
pub(super) mod intersections;
pub(super) mod minimal_triangulation;
