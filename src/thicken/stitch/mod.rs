//! The strips between the boundary of the patch and the rims of the section (\[WC13\] section 4.1).

mod boundary_curve;
pub(super) mod join;
pub(super) mod open_mesh;
pub(super) mod rim;
mod small_rims;
mod strip;
mod strip_fitting;
