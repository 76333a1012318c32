//! The results of the operations: a mesh, a band, or statistics where the mesh went elsewhere.

use super::OffsetStatistics;
use crate::io::{self, SaveError, SaveOptions};
use crate::mesh::TriMesh;
use crate::quantity::Precision;
#[cfg(feature = "openvdb")]
use crate::vdb::Band;
use std::path::Path;

/// An offset surface as a mesh.
#[derive(Debug)]
pub struct OffsetResult {
    /// The offset surface: closed, 2-manifold, free of intersections.
    pub mesh: TriMesh,
    /// The number type that the mesh's coordinates are made for.
    pub precision: Precision,
    /// The narrow band in OpenVDB grids, where the settings asked for it.
    #[cfg(feature = "openvdb")]
    pub band: Option<Band>,
    /// Counts and times of the run.
    pub statistics: OffsetStatistics,
}

impl OffsetResult {
    /// Saves the mesh with coordinates of its precision, in the format that belongs to the
    /// extension of `path`. The promises for the mesh hold for the file.
    ///
    /// # Errors
    /// As [`save`](crate::io::save). STL has no 64-bit coordinates.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SaveError> {
        io::save(&self.mesh, path.as_ref(), &SaveOptions { precision: self.precision })
    }
}

/// The narrow band of an offset surface, without a mesh.
#[cfg(feature = "openvdb")]
#[derive(Debug)]
pub struct BandResult {
    /// The band in OpenVDB grids: phi, and the closest triangles where they were asked for.
    pub band: Band,
    /// Counts and times of the run.
    pub statistics: OffsetStatistics,
}

/// The rest of an offset whose mesh went to a [`MeshSink`](super::MeshSink).
#[derive(Debug)]
pub struct StreamResult {
    /// The narrow band in OpenVDB grids, where the settings asked for it. That of a tile is the
    /// tile's.
    #[cfg(feature = "openvdb")]
    pub band: Option<Band>,
    /// Counts and times of the run. Those of a tile are the tile's.
    pub statistics: OffsetStatistics,
}
