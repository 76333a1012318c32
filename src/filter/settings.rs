//! Switches of the filters. All filters are on, except to measure the work that each one saves
//! (\[LW11\] Table IV).

use crate::lattice::LEAF_DIM;

/// The switch of a filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Switch {
    /// The filter is applied.
    #[default]
    On,
    /// The filter is not applied: blocks that it would reject are kept.
    Off,
}

/// The size of the bounding boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BoxSide {
    /// About eight boxes along the grid's longest side.
    #[default]
    Automatic,
    /// 2^n cells along each axis, n from 3 to [`MAX_BOX_EXPONENT`].
    PowerOfTwo(u32),
}

/// The largest exponent of a box side: boxes larger than a grid of 4096 cells hold all of it.
pub const MAX_BOX_EXPONENT: u32 = 12;

/// The filters of \[LW11\] section IV, each to be switched off. The band is the same whatever is
/// on, for closed input; the number of distance computations is not.
///
/// ```
/// use exocarp::internals::filter::{BoxSide, FilterSettings, Switch};
///
/// // "BB + OT" of Table IV, with boxes of 128 cells.
/// let settings = FilterSettings {
///     side: BoxSide::PowerOfTwo(7),
///     signed_distance: Switch::Off,
///     ..FilterSettings::default()
/// };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct FilterSettings {
    /// The size of the bounding boxes.
    pub side: BoxSide,
    /// The bounding box filter.
    pub bounding_box: Switch,
    /// The signed distance filter. Without it the octree filter, too, goes by unsigned distances.
    pub signed_distance: Switch,
    /// The octree filter.
    pub octree: Switch,
    /// Candidate lists within leaves, instead of a query for each block and node. They need the
    /// octree filter.
    pub candidates: Switch,
}

/// A box side out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("bounding boxes have 2^3 to 2^{MAX_BOX_EXPONENT} cells along an axis, not 2^{0}")]
pub struct BoxSideError(pub u32);

impl FilterSettings {
    /// Checks the box side.
    ///
    /// # Errors
    /// When it is smaller than a leaf, which would be evaluated in parts, or larger than any grid.
    pub fn validate(&self) -> Result<(), BoxSideError> {
        match self.side {
            BoxSide::PowerOfTwo(n) if !(LEAF_DIM.ilog2()..=MAX_BOX_EXPONENT).contains(&n) => {
                Err(BoxSideError(n))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_whole_leaves() {
        let with = |side| FilterSettings { side, ..FilterSettings::default() }.validate();
        assert_eq!(with(BoxSide::PowerOfTwo(2)), Err(BoxSideError(2)));
        assert_eq!(with(BoxSide::PowerOfTwo(13)), Err(BoxSideError(13)));
        assert!(with(BoxSide::PowerOfTwo(3)).is_ok() && with(BoxSide::Automatic).is_ok());
    }
}
