//! The contour without its inset, and its joining to the patch (\[WC13\] section 4.2).

mod boundary_curve;
pub(super) mod join;
pub(super) mod open_mesh;
pub(super) mod rim;
mod small_rims;
mod strip;
mod strip_fitting;
