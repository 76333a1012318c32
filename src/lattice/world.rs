//! World positions of nodes, and the value outside of a band.

use super::Ijk;

/// World positions of lattice nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Voxel size h in model units: the width of a cell.
    pub voxel: f64,
}

/// Factor by which a background is larger than half-width times voxel size at least: two units in
/// the last place of an f32. Then neither the voxel size rounded to f32 nor a division or product
/// rounded to it makes fewer voxels of the background: these are off by a quarter of that each.
/// Much more, and nodes farther out would be in the band.
const BACKGROUND_MARGIN: f64 = 1.0 + 2.0 * f32::EPSILON as f64;

impl Lattice {
    /// Returns the world coordinate of the node plane with index `i` along any axis.
    pub fn plane(&self, i: i32) -> f64 {
        self.voxel * f64::from(i)
    }

    /// Returns the value of nodes outside a band of `half_width` voxels, as stored: slightly above
    /// their product, in model units. Other programs count the voxels back, in 32 or 64 bits, and
    /// take what is less than three for no level set.
    pub fn background(&self, half_width: f64) -> f32 {
        let least = half_width * self.voxel * BACKGROUND_MARGIN;
        let background = least as f32;
        if f64::from(background) < least { background.next_up() } else { background }
    }

    /// Returns the world position of node `ijk`.
    pub fn world_from_index(&self, ijk: Ijk) -> [f64; 3] {
        ijk.0.map(|i| self.plane(i))
    }
}
