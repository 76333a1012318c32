//! The methods of bands and grids that read and write `.vdb` files.

use super::{ClosestGrid, FileInfo, SurfaceGrid, VdbError, VdbOptions, file, info, tiles};
use crate::io::Tile;
use crate::vdb::Band;
use std::path::Path;

impl Band {
    /// Writes the band to the file `path`: the level set, which every OpenVDB program reads, and
    /// the closest triangles where the band has them.
    ///
    /// # Errors
    /// If the file cannot be written whole, or the voxel size is below 1.5e-5 model units or beyond
    /// what half floats can hold.
    pub fn save(&self, path: impl AsRef<Path>, options: &VdbOptions) -> Result<(), VdbError> {
        file::write(path.as_ref(), &self.surface, self.closest.as_ref(), options)
    }

    /// Writes the band of a tile to the file `path`, for [`merge_bands`](super::merge_bands).
    ///
    /// # Errors
    /// Those of [`save`](Self::save).
    pub fn save_tile(
        &self,
        path: impl AsRef<Path>,
        tile: Tile,
        options: &VdbOptions,
    ) -> Result<(), VdbError> {
        tiles::write_tile(path.as_ref(), self, tile, options)
    }

    /// Opens a band that [`save`](Self::save) wrote, or another program's level set as
    /// [`SurfaceGrid::open`] does. The closest triangles are there if the file has them for exactly
    /// the leaves of the surface.
    ///
    /// # Errors
    /// Those of [`SurfaceGrid::open`].
    pub fn open(path: impl AsRef<Path>) -> Result<Band, VdbError> {
        file::open_band(path.as_ref())
    }
}

impl SurfaceGrid {
    /// Opens the level set `name` of a file; without a name the grid `surface`, or else the only
    /// float grid.
    ///
    /// Any program's file will do, as long as its transform is a uniform scale and a translation,
    /// and its background positive. Fog volumes are refused.
    ///
    /// # Errors
    /// If the file cannot be read, or has no such grid, or one that is not a level set.
    pub fn open(path: impl AsRef<Path>, name: Option<&str>) -> Result<SurfaceGrid, VdbError> {
        file::open_surface(path.as_ref(), name)
    }
}

impl ClosestGrid {
    /// Opens the grid of closest triangles `name`; without a name the grid `surface_closest`, or
    /// else the only grid of 32-bit integers.
    ///
    /// # Errors
    /// If the file cannot be read or has no such grid.
    pub fn open(path: impl AsRef<Path>, name: Option<&str>) -> Result<ClosestGrid, VdbError> {
        file::open_closest(path.as_ref(), name)
    }
}

impl FileInfo {
    /// Reads what a file says about itself and its grids, and counts the active voxels. Any
    /// program's grids will do.
    ///
    /// # Errors
    /// If the file cannot be read or is not an OpenVDB file.
    pub fn read(path: impl AsRef<Path>) -> Result<FileInfo, VdbError> {
        info::info(path.as_ref())
    }
}
