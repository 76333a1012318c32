//! The number of a tile among the tiles of one offset.

use super::ParseQuantityError;
use std::fmt;
use std::str::FromStr;

/// One of several tiles that together are one offset: tile 3 of 8, as text `3/8`.
///
/// ```
/// use exocarp::TileIndex;
///
/// let tile: TileIndex = "3/8".parse().unwrap();
/// assert_eq!((tile.index(), tile.count()), (3, 8));
/// assert!("9/8".parse::<TileIndex>().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileIndex {
    index: u32,
    count: u32,
}

impl TileIndex {
    /// Returns tile `index`, counted from 1, of `count` tiles; `None` where there is no such tile.
    pub fn new(index: u32, count: u32) -> Option<TileIndex> {
        (1..=count).contains(&index).then_some(TileIndex { index, count })
    }

    /// Returns the number of the tile, 1 to [`count`](Self::count).
    pub fn index(self) -> u32 {
        self.index
    }

    /// Returns the number of tiles, at least 1.
    pub fn count(self) -> u32 {
        self.count
    }
}

impl FromStr for TileIndex {
    type Err = ParseQuantityError;

    fn from_str(text: &str) -> Result<TileIndex, ParseQuantityError> {
        let wrong = || ParseQuantityError("a tile is one of several, like 3/8".into());
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let index = index.trim().parse().map_err(|_| wrong())?;
        let count = count.trim().parse().map_err(|_| wrong())?;
        TileIndex::new(index, count)
            .ok_or_else(|| ParseQuantityError(format!("tiles are numbered 1 to {count}")))
    }
}

impl fmt::Display for TileIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_numbered_from_one() {
        for text in ["1/1", "3/8", "4294967295/4294967295"] {
            assert_eq!(text.parse::<TileIndex>().unwrap().to_string(), text);
        }
        for wrong in ["", "3", "0/8", "9/8", "0/0", "-1/8", "1/4294967296", "3/8/9", "a/b"] {
            assert!(wrong.parse::<TileIndex>().is_err(), "{wrong}");
        }
        assert_eq!(TileIndex::new(0, 4), None);
    }
}
