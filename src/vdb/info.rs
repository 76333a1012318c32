//! Contents of a `.vdb` file, without its values.

use super::VdbError;
use super::bridge::ffi;
use super::file::contents;
use crate::lattice::Ijk;
use std::path::Path;

/// A file's header and grids.
#[derive(Clone, Debug, PartialEq)]
pub struct FileInfo {
    /// Version of the file format: 224 from OpenVDB 10 to 12.
    pub format: u32,
    /// Version of the OpenVDB that wrote the file.
    pub library: String,
    /// The file's metadata: names with values as text.
    pub metadata: Vec<(String, String)>,
    /// The grids in the order of the file.
    pub grids: Vec<GridInfo>,
}

/// A grid in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct GridInfo {
    /// Name of the grid; a repeated one has its number behind it: `name[1]`.
    pub name: String,
    /// Type of its values: `float`, `int32`, `vec3s`, ...
    pub value_type: String,
    /// Class of the grid: `level set`, `fog volume`, `staggered vector field` or `unknown`.
    pub class: String,
    /// Widths of a voxel in model units.
    pub voxel: [f64; 3],
    /// World position of node (0, 0, 0) in model units.
    pub translation: [f64; 3],
    /// Number of active voxels, those of active tiles included.
    pub active_voxels: u64,
    /// Lowest and highest active node.
    pub index_bbox: Option<[Ijk; 2]>,
    /// The bounding box of the active nodes in model units.
    pub world_bbox: Option<[[f64; 3]; 2]>,
    /// The background value as text.
    pub background: String,
    /// The grid's metadata: names with values as text. Those that begin with `file_` are
    /// statistics.
    pub metadata: Vec<(String, String)>,
}

/// Reads what the file says about itself and its grids, and counts the active voxels. Any program's
/// grids will do.
///
/// # Errors
/// If the file cannot be read or is not an OpenVDB file.
pub fn info(path: &Path) -> Result<FileInfo, VdbError> {
    let contents = contents(path, ffi::Depth::Topology)?;
    Ok(FileInfo {
        format: contents.format,
        library: contents.library,
        metadata: pairs(contents.metadata),
        grids: contents.grids.into_iter().map(grid_info).collect(),
    })
}

fn grid_info(entry: ffi::GridEntry) -> GridInfo {
    let frame = entry.placement.frame;
    let [zero, x, y, z] = [0, 3, 6, 9].map(|n| [frame[n], frame[n + 1], frame[n + 2]]);
    let steps = [x, y, z].map(|end| [0, 1, 2].map(|i| end[i] - zero[i]));
    let world = |node: Ijk| {
        [0, 1, 2].map(|i| zero[i] + (0..3).map(|axis| f64::from(node.0[axis]) * steps[axis][i]).sum::<f64>())
    };
    let b = entry.bbox;
    let bbox = [Ijk::new(b[0], b[1], b[2]), Ijk::new(b[3], b[4], b[5])];
    let has_box = entry.active_voxels > 0;
    GridInfo {
        name: entry.name,
        value_type: entry.value_type,
        class: entry.grid_class,
        voxel: steps.map(|s| s.iter().map(|c| c * c).sum::<f64>().sqrt()),
        translation: zero,
        active_voxels: entry.active_voxels,
        index_bbox: has_box.then_some(bbox),
        world_bbox: has_box.then(|| around(&bbox, world)),
        background: entry.background,
        metadata: pairs(entry.metadata),
    }
}

/// The box around the images of all corners: a transform may turn the grid.
fn around(bbox: &[Ijk; 2], world: impl Fn(Ijk) -> [f64; 3]) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for corner in 0..8 {
        let p = world(Ijk([0, 1, 2].map(|axis| bbox[corner >> axis & 1].0[axis])));
        for i in 0..3 {
            bounds[0][i] = bounds[0][i].min(p[i]);
            bounds[1][i] = bounds[1][i].max(p[i]);
        }
    }
    bounds
}

fn pairs(items: Vec<ffi::MetaItem>) -> Vec<(String, String)> {
    items.into_iter().map(|item| (item.name, item.text)).collect()
}
