//! The bounding box filter (\[LW11\] section IV.B, Remarks 1 and 2): by the unsigned distance at
//! the centre.

/// Whether no node of a block is valid, whichever side of the model it is on.
///
/// `unsigned` is the unsigned distance at the block's centre, `depth` = abs(r), `reach` = band
/// half-width plus the block's radius, all in model units.
pub(super) fn rejects(unsigned: f64, depth: f64, reach: f64) -> bool {
    (unsigned - depth).abs() > reach
}
