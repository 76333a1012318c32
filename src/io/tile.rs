//! Tiles: files that hold a share of a result each, and what joins them needs to know.

use crate::quantity::TileIndex;
use std::io;
use std::path::{Path, PathBuf};

/// The identity of a tile: its number, and the offset that it is a share of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The number of the tile, and that of all tiles.
    pub index: TileIndex,
    /// A number made of the input and the settings: tiles with different ones do not belong
    /// together.
    pub job: u64,
}

/// Why tiles cannot be merged.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", .path.display())]
pub struct MergeError {
    /// The tile, or the output.
    pub path: PathBuf,
    /// The cause.
    #[source]
    pub kind: MergeErrorKind,
}

/// The cause of a [`MergeError`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MergeErrorKind {
    /// The file cannot be read.
    #[error("the file cannot be read ({0}); check the path and the permissions")]
    Read(#[source] io::Error),
    /// The file is no tile.
    #[error("this is not a tile, a .ply, .stl or .vdb file with one share of an offset")]
    NotATile,
    /// A tile is of another input, or was made with other settings.
    #[error("this tile is of another model, or was made with other settings; make all tiles alike")]
    OtherJob,
    /// The format of a tile, with this extension, is not that of the output.
    #[error("tiles and output must have the same format; here it is .{0}")]
    OtherFormat(&'static str),
    /// A tile is there twice.
    #[error("tile {0} is there twice; name each tile once")]
    Twice(u32),
    /// A tile is not there.
    #[error("tile {number} of {of} is missing; make it and name it, too")]
    Missing {
        /// Number of the tile, from 1.
        number: u32,
        /// Number of tiles.
        of: u32,
    },
    /// A vertex that another tile should have is nowhere.
    #[error("the tiles do not fit together; make them again with one version of exocarp")]
    NoFit,
    /// No tile holds anything.
    #[error("no tile holds any of the surface: the result is empty")]
    Empty,
    /// The output cannot be written.
    #[error("writing failed ({0}); check the free space, the output was left as it was")]
    Write(#[source] io::Error),
    /// The whole is too large for its format.
    #[error("the whole has more than {} vertices or triangles, the limit of the format", u32::MAX)]
    TooLarge,
}

impl Tile {
    /// The text in a file, from which it is read again; `note` is what else must be known of the
    /// file, without commas.
    pub(crate) fn text(&self, note: &str) -> String {
        format!(
            "exocarp tile {} of {}, {note}, job {:016x}",
            self.index.index(),
            self.index.count(),
            self.job
        )
    }

    /// A tile and its note from the text in a file.
    pub(crate) fn parse(text: &str) -> Option<(Tile, &str)> {
        let rest = text.trim_end().strip_prefix("exocarp tile ")?;
        let (number, rest) = rest.split_once(" of ")?;
        let (of, rest) = rest.split_once(", ")?;
        let (note, job) = rest.split_once(", job ")?;
        let job = u64::from_str_radix(job, 16).ok()?;
        let index = TileIndex::new(number.parse().ok()?, of.parse().ok()?)?;
        Some((Tile { index, job }, note))
    }
}

/// Checks that tiles in the order of their numbers are all those of one work, each once.
pub(crate) fn check_complete(tiles: &[(&Path, Tile)]) -> Result<(), MergeError> {
    let failed = |path: &Path, kind| Err(MergeError { path: path.to_path_buf(), kind });
    let Some(&(first, Tile { index, job })) = tiles.first() else {
        return failed(Path::new(""), MergeErrorKind::Missing { number: 1, of: 1 });
    };
    let of = index.count();
    if let Some(other) = tiles.iter().find(|(_, tile)| (tile.index.count(), tile.job) != (of, job)) {
        return failed(other.0, MergeErrorKind::OtherJob);
    }
    if let Some(pair) = tiles.windows(2).find(|pair| pair[0].1.index == pair[1].1.index) {
        return failed(pair[1].0, MergeErrorKind::Twice(pair[1].1.index.index()));
    }
    match (1..=of).find(|n| !tiles.iter().any(|(_, tile)| tile.index.index() == *n)) {
        Some(number) => failed(first, MergeErrorKind::Missing { number, of }),
        None => Ok(()),
    }
}
