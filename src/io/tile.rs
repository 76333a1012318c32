//! Tiles: files that hold a share of a result each, and what joins them needs to know.

use std::io;
use std::path::{Path, PathBuf};

/// The share of a tile, and the work that it is a share of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Number of the tile, from 1.
    pub number: u32,
    /// Number of tiles.
    pub of: u32,
    /// Identifies the input and the settings: tiles with different ones do not belong together.
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
    /// The text in a file, from which it is read again; `note` is what else must be known of the file, without commas.
    pub(crate) fn text(&self, note: &str) -> String {
        format!("exocarp tile {} of {}, {note}, job {:016x}", self.number, self.of, self.job)
    }

    /// A tile and its note from the text in a file.
    pub(crate) fn parse(text: &str) -> Option<(Tile, &str)> {
        let rest = text.trim_end().strip_prefix("exocarp tile ")?;
        let (number, rest) = rest.split_once(" of ")?;
        let (of, rest) = rest.split_once(", ")?;
        let (note, job) = rest.split_once(", job ")?;
        let job = u64::from_str_radix(job, 16).ok()?;
        let tile = Tile { number: number.parse().ok()?, of: of.parse().ok()?, job };
        ((1..=tile.of).contains(&tile.number)).then_some((tile, note))
    }
}

/// Checks that tiles in the order of their numbers are all those of one work, each once.
pub(crate) fn check_complete(tiles: &[(&Path, Tile)]) -> Result<(), MergeError> {
    let failed = |path: &Path, kind| Err(MergeError { path: path.to_path_buf(), kind });
    let Some(&(first, Tile { of, job, .. })) = tiles.first() else {
        return failed(Path::new(""), MergeErrorKind::Missing { number: 1, of: 1 });
    };
    if let Some(other) = tiles.iter().find(|(_, tile)| (tile.of, tile.job) != (of, job)) {
        return failed(other.0, MergeErrorKind::OtherJob);
    }
    if let Some(pair) = tiles.windows(2).find(|pair| pair[0].1.number == pair[1].1.number) {
        return failed(pair[1].0, MergeErrorKind::Twice(pair[1].1.number));
    }
    match (1..=of).find(|n| !tiles.iter().any(|(_, tile)| tile.number == *n)) {
        Some(number) => failed(first, MergeErrorKind::Missing { number, of }),
        None => Ok(()),
    }
}
