//! An element of a PLY file that is of no interest.

use ply_rs_bw::ply::PropertyAccess;

/// An element that is read past: none of its properties is kept.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Skipped
    }
}
