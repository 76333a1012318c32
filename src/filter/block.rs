//! Cubic blocks of grid nodes.

use crate::lattice::{Ijk, LEAF_DIM, Lattice};
use glam::DVec3;

/// The nodes `origin` .. `origin + width - 1` along each axis.
///
/// The paper's boxes hold m^3 cells and share their border nodes; these hold m^3 nodes, so that
/// each node is in one block, and reach half a cell less far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// The lowest node.
    pub origin: Ijk,
    /// Nodes along each axis, a power of two.
    pub width: i32,
}

impl Block {
    /// Returns the world position of the centre of the block's nodes.
    pub fn centre(&self, lattice: Lattice) -> DVec3 {
        let half = 0.5 * f64::from(self.width - 1);
        DVec3::from(self.origin.0.map(|i| lattice.voxel * (f64::from(i) + half)))
    }

    /// Returns the radius of the sphere through the block's corner nodes: the papers' delta.
    pub fn radius(&self, lattice: Lattice) -> f64 {
        0.5 * 3f64.sqrt() * f64::from(self.width - 1) * lattice.voxel
    }

    /// Returns the origins of the leaves in the block, z fastest. The block's width must be a
    /// multiple of a leaf's.
    pub fn leaves(&self) -> impl Iterator<Item = Ijk> + use<> {
        let Block { origin, width } = *self;
        let steps = move || (0..width).step_by(LEAF_DIM as usize);
        steps().flat_map(move |x| steps().flat_map(move |y| steps().map(move |z| origin + Ijk::new(x, y, z))))
    }

    /// Returns the eight octants, z fastest.
    pub fn children(&self) -> [Block; 8] {
        let width = self.width / 2;
        std::array::from_fn(|n| {
            let n = n as i32;
            Block {
                origin: self.origin + Ijk::new((n >> 2) * width, (n >> 1 & 1) * width, (n & 1) * width),
                width,
            }
        })
    }
}
