//! The patch as it comes: its boundary, its holes, and the exact test that it meets nothing.

pub(super) mod boundary;
pub(super) mod holes;
pub(super) mod intersections;
pub(super) mod minimal_triangulation;
