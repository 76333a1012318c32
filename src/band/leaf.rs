//! A leaf of the band while it is filled.

use super::{LeafBatch, inside_mask};
use crate::candidates::block_in_leaf;
use crate::filter::Block;
use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE, LeafMask, Z_LAST};

/// The outcome of a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LeafOutcome {
    /// The leaf is in the batch.
    Kept,
    /// No node of the leaf is in the band.
    Dropped,
}

pub(super) struct Leaf {
    pub(super) values: [f32; LEAF_SIZE],
    pub(super) active: [u64; 8],
    pub(super) closest: [i32; LEAF_SIZE],
}

impl Leaf {
    pub(super) fn new() -> Self {
        Leaf { values: [0.0; LEAF_SIZE], active: [0; 8], closest: [-1; LEAF_SIZE] }
    }

    /// Sets a node to `phi`, whose closest triangle is `triangle`.
    #[inline]
    pub(super) fn set(&mut self, number: usize, phi: f64, triangle: u32, background: f32) {
        if phi.abs() < f64::from(background) {
            self.values[number] = stored(phi, background);
            self.closest[number] = triangle as i32;
            self.active[number >> 6] |= 1 << (number & 63);
        } else {
            self.values[number] = background.copysign(phi as f32);
        }
    }

    /// Sets all nodes of a block.
    pub(super) fn fill(&mut self, block: Block, value: f32) {
        let first = block.origin.number_in_leaf();
        let width = block.width as usize;
        for x in 0..width {
            for y in 0..width {
                let row = first + 64 * x + 8 * y;
                self.values[row..row + width].fill(value);
            }
        }
    }

    /// Appends the leaf at `origin` to `batch`, unless no node of it is active.
    pub(super) fn finish(&self, origin: Ijk, batch: &mut LeafBatch) -> LeafOutcome {
        let inside = inside_mask(&self.values);
        let is_uniform = inside == [0; 8] || inside == [!0; 8];
        if !is_uniform || self.active.iter().any(|&word| word != 0) {
            batch.origins.push(origin);
            batch.values.extend_from_slice(&self.values);
            batch.active.push(self.active);
            batch.inside.push(inside);
            batch.closest.extend_from_slice(&self.closest);
            return LeafOutcome::Kept;
        }
        if self.values[0] < 0.0 {
            // Without active nodes there is no sign change, unless the input is not closed.
            batch.inside_blocks.push((origin, LEAF_DIM));
        }
        LeafOutcome::Dropped
    }

    /// Appends the leaf at `origin` to `batch` without values, unless no node of it is active or
    /// inside. A negative value marks a node that is known to be inside.
    pub(super) fn finish_unsigned(&self, origin: Ijk, batch: &mut LeafBatch) -> LeafOutcome {
        let inside = inside_mask(&self.values);
        if self.active == [0; 8] && inside == [0; 8] {
            return LeafOutcome::Dropped;
        }
        batch.origins.push(origin);
        batch.active.push(self.active);
        batch.inside.push(inside);
        batch.closest.extend_from_slice(&self.closest);
        LeafOutcome::Kept
    }
}

/// Returns the blocks of 2^3 nodes, by number, with a node that is the lowest one of a cell with
/// nodes on both sides of the surface, or may be: nodes beyond the leaf are taken to be on the side
/// of the nearest node in it, unless that is in the band.
pub(super) fn blocks_with_crossed_cells(inside: &LeafMask, active: &LeafMask) -> u64 {
    let outside = inside.map(|word| !word);
    let [inside, outside, active] = [inside, &outside, active].map(in_any_corner);
    let mut blocks = 0;
    for x in 0..8 {
        let last = if x == 7 { !0 } else { Y_LAST | Z_LAST };
        let mut cells = inside[x] & outside[x] | active[x] & last;
        while cells != 0 {
            let node = 64 * x + cells.trailing_zeros() as usize;
            blocks |= 1 << block_in_leaf(Ijk::in_leaf(Ijk::default(), node));
            cells &= cells - 1;
        }
    }
    blocks
}

/// The bits with y = 7 in a word of a [`LeafMask`].
const Y_LAST: u64 = 0xff << 56;

/// Returns the nodes that are in a mask, or one step along some of the axes before one that is.
fn in_any_corner(mask: &LeafMask) -> LeafMask {
    std::array::from_fn(|x| {
        let along_x = mask[x] | mask.get(x + 1).copied().unwrap_or(0);
        let along_y = along_x | along_x >> 8;
        along_y | (along_y >> 1 & !Z_LAST)
    })
}

/// Rounds phi to an f32 that keeps its sign and stays below the background. Zero becomes the
/// smallest positive value.
fn stored(phi: f64, background: f32) -> f32 {
    let magnitude = (phi.abs() as f32).clamp(f32::MIN_POSITIVE, background.next_down());
    if phi < 0.0 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_those_of_crossed_cells() {
        let sphere = |node: Ijk, centre: [f64; 3], radius: f64| {
            let [x, y, z] = std::array::from_fn(|a| f64::from(node.0[a]) - centre[a]);
            (x * x + y * y + z * z).sqrt() - radius
        };
        for (centre, radius) in [([3.2, 4.1, 2.7], 2.3), ([0.3, -1.0, 12.0], 7.4), ([9.1, 8.7, 3.3], 4.9)] {
            let phi = |node: Ijk| sphere(node, centre, radius);
            let (mut inside, mut active) = ([0; 8], [0; 8]);
            for number in 0..LEAF_SIZE {
                let phi = phi(Ijk::in_leaf(Ijk::default(), number));
                inside[number >> 6] |= u64::from(phi < 0.0) << (number & 63);
                active[number >> 6] |= u64::from(phi.abs() < 1.0) << (number & 63);
            }
            let found = blocks_with_crossed_cells(&inside, &active);
            let (mut crossed, mut within) = (0u64, 0u64);
            for number in 0..LEAF_SIZE {
                let node = Ijk::in_leaf(Ijk::default(), number);
                let corners = (0..8).map(|n| node + Ijk([n >> 2, n >> 1 & 1, n & 1]));
                let sides: Vec<bool> = corners.map(|corner| phi(corner) < 0.0).collect();
                let block = 1 << block_in_leaf(node);
                crossed |= if sides.contains(&true) && sides.contains(&false) { block } else { 0 };
                within |= if node.0.iter().all(|&x| x < 6) { block } else { 0 };
            }
            // Nodes two steps from the leaf's last ones can be on another side than those.
            assert_eq!(found & within, crossed & within);
            assert!((crossed & !found).count_ones() <= 1, "{centre:?}");
            assert!(found.count_ones() < crossed.count_ones() + 16);
        }
    }
}
