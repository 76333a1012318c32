//! Tiles of bands: `.vdb` files whose metadata name the share that they hold.
//!
//! A tile holds the leaves of its slab and the inside beyond them, so that joining is taking all of
//! both: no value is computed again. Trees of the same leaves and tiles are the same tree, and the
//! file's bytes are those of the whole.

use super::bridge::ffi;
use super::error::VdbError;
use super::file::{self, Compression, MetaValue, VdbOptions};
use super::grid::{Band, ClosestGrid, SurfaceGrid};
use crate::io::tile::{MergeError, MergeErrorKind, Tile, check_complete};
use std::path::{Path, PathBuf};

/// Name of the metadata entry that makes a file a tile.
const ENTRY: &str = "tile";

/// The names of the ways to compress, in a tile's text: the format does not keep the choice where
/// it is read.
const CODECS: [(Compression, &str); 3] =
    [(Compression::Blosc, "blosc"), (Compression::Zip, "zip"), (Compression::None, "none")];

/// Writes the band of a tile, as [`Band::save`] does.
///
/// # Errors
/// Those of [`Band::save`].
pub fn write_tile(path: &Path, band: &Band, tile: Tile, options: &VdbOptions) -> Result<(), VdbError> {
    let codec = CODECS.iter().find(|(c, _)| *c == options.compression).map_or("none", |(_, name)| name);
    let mut options = options.clone();
    options.metadata.push((ENTRY.into(), MetaValue::Text(tile.text(codec))));
    file::write(path, &band.surface, band.closest.as_ref(), &options)
}

/// A tile's file.
struct TileFile {
    path: PathBuf,
    tile: Tile,
    compression: Compression,
    metadata: Vec<ffi::MetaItem>,
}

impl TileFile {
    fn open(path: &Path) -> Result<TileFile, VdbError> {
        let mut metadata = file::contents(path, ffi::Depth::Names)?.metadata;
        let place = metadata.iter().position(|item| item.name == ENTRY);
        let found = place.and_then(|n| {
            let entry = metadata.remove(n);
            let (tile, codec) = Tile::parse(&entry.text)?;
            let compression = CODECS.iter().find(|(_, name)| *name == codec)?.0;
            Some((tile, compression))
        });
        let path = path.to_path_buf();
        match found {
            Some((tile, compression)) => Ok(TileFile { path, tile, compression, metadata }),
            None => Err(MergeError { path, kind: MergeErrorKind::NotATile }.into()),
        }
    }

    fn agrees_with(&self, other: &TileFile) -> bool {
        let facts = |t: &TileFile| -> Vec<(String, String)> {
            t.metadata.iter().map(|item| (item.name.clone(), item.text.clone())).collect()
        };
        self.compression == other.compression && facts(self) == facts(other)
    }
}

/// Joins all tiles of a work to the band that it gives undivided, byte for byte, in the file
/// `output`, which is replaced whole. Tiles may come in any order. Returns the joined band.
///
/// # Errors
/// When a file is no tile, is of another work, is there twice or not at all, or when reading or
/// writing fails.
pub fn merge_bands(tiles: &[PathBuf], output: &Path) -> Result<Band, VdbError> {
    let mut tiles: Vec<TileFile> = tiles.iter().map(|path| TileFile::open(path)).collect::<Result<_, _>>()?;
    tiles.sort_by_key(|tile| tile.tile.index.index());
    check_complete(&tiles.iter().map(|t| (t.path.as_path(), t.tile)).collect::<Vec<_>>())?;
    let (first, others) = tiles.split_first().expect("complete tiles are not none");
    let mut whole = file::open_band(&first.path)?;
    for other in others {
        let fault = || MergeError { path: other.path.clone(), kind: MergeErrorKind::OtherJob };
        let part = file::open_band(&other.path)?;
        let same = part.surface.background() == whole.surface.background()
            && part.surface.lattice() == whole.surface.lattice()
            && part.closest.is_some() == whole.closest.is_some();
        if !same || !other.agrees_with(first) {
            return Err(fault().into());
        }
        whole.append(&part)?;
    }
    if whole.surface.leaf_count() == 0 {
        return Err(MergeError { path: output.to_path_buf(), kind: MergeErrorKind::Empty }.into());
    }
    whole.surface.prune();
    let Band { surface, closest } = &whole;
    file::write_grids(output, &surface.grid, closest.as_ref(), first.compression, &first.metadata)?;
    Ok(whole)
}

impl Band {
    /// Adds the leaves and the inside of another part of the same band.
    fn append(&mut self, part: &Band) -> Result<(), VdbError> {
        let Band { surface: SurfaceGrid { grid, .. }, closest } = self;
        grid.pin_mut().append(&part.surface.grid)?;
        if let (Some(ClosestGrid { grid }), Some(ids)) = (closest, &part.closest) {
            grid.pin_mut().append(&ids.grid)?;
        }
        Ok(())
    }
}
