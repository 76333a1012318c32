//! A leaf of the band while it is filled.

use super::{LeafBatch, inside_mask};
use crate::filter::Block;
use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE};

/// What became of a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It is in the batch.
    Kept,
    /// No node of it is in the band.
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
        let side = block.side as usize;
        for x in 0..side {
            for y in 0..side {
                let row = first + 64 * x + 8 * y;
                self.values[row..row + side].fill(value);
            }
        }
    }

    /// Appends the leaf at `origin` to `batch`, unless no node of it is active.
    pub(super) fn finish(&self, origin: Ijk, batch: &mut LeafBatch) -> Fate {
        let inside = inside_mask(&self.values);
        let is_uniform = inside == [0; 8] || inside == [!0; 8];
        if !is_uniform || self.active.iter().any(|&word| word != 0) {
            batch.origins.push(origin);
            batch.values.extend_from_slice(&self.values);
            batch.active.push(self.active);
            batch.inside.push(inside);
            batch.closest.extend_from_slice(&self.closest);
            return Fate::Kept;
        }
        if self.values[0] < 0.0 {
            // Without active nodes there is no sign change, unless the input is not closed.
            batch.inside_blocks.push((origin, LEAF_DIM));
        }
        Fate::Dropped
    }

    /// The same without values. Nodes with negative ones are those that are known to be inside.
    pub(super) fn finish_unsigned(&self, origin: Ijk, batch: &mut LeafBatch) -> Fate {
        let inside = inside_mask(&self.values);
        if self.active == [0; 8] && inside == [0; 8] {
            return Fate::Dropped;
        }
        batch.origins.push(origin);
        batch.active.push(self.active);
        batch.inside.push(inside);
        batch.closest.extend_from_slice(&self.closest);
        Fate::Kept
    }
}

/// phi as an f32 that keeps its sign and stays below the background; zero becomes the smallest positive
/// value.
fn stored(phi: f64, background: f32) -> f32 {
    let magnitude = (phi.abs() as f32).clamp(f32::MIN_POSITIVE, background.next_down());
    if phi < 0.0 { -magnitude } else { magnitude }
}
