//! The blocks of nodes that are inside as a whole: all of the inside beyond the leaves.

use crate::lattice::leaf_index::{BLOCK_DIM, block, blocks_of, find, number_in_block};
use crate::lattice::{Ijk, LEAF_DIM, LeafMask};
use rayon::prelude::*;

/// Blocks that do not overlap.
#[derive(Clone, Debug, Default)]
pub struct InsideBlocks {
    /// Blocks of 8^3 leaves that hold inside blocks of at most that size, ascending.
    blocks: Vec<Ijk>,
    /// A bit for each inside leaf, by block.
    masks: Vec<LeafMask>,
    /// Larger inside blocks: their width, a power of two, and their origins in ascending order.
    larger: Vec<(i32, Vec<Ijk>)>,
}

impl InsideBlocks {
    /// Returns the set of some blocks, given as origin and width in nodes. Widths are powers of
    /// two, and origins multiples of them.
    pub fn new(inside: &[(Ijk, i32)]) -> InsideBlocks {
        let small = || inside.iter().filter(|b| b.1 <= BLOCK_DIM);
        let blocks = blocks_of(small().map(|b| b.0));
        let mut masks = vec![[0; 8]; blocks.len()];
        let mut at = 0;
        for &(origin, side) in small() {
            let mask: &mut LeafMask = &mut masks[find(&blocks, &mut at, origin)];
            let (first, n) = (number_in_block(origin), (side / LEAF_DIM) as usize);
            let row = (1 << n) - 1;
            for word in &mut mask[first >> 6..][..n] {
                *word |= (0..n).fold(0, |rows, y| rows | row << (8 * y)) << (first & 63);
            }
        }
        let mut larger = Vec::new();
        let mut side = 2 * BLOCK_DIM;
        while inside.iter().any(|b| b.1 >= side) {
            let mut origins: Vec<Ijk> = inside.iter().filter(|b| b.1 == side).map(|b| b.0).collect();
            origins.sort_unstable();
            if !origins.is_empty() {
                larger.push((side, origins));
            }
            side *= 2;
        }
        InsideBlocks { blocks, masks, larger }
    }

    /// Returns for each node whether one of the blocks holds it.
    pub fn contain(&self, nodes: &[Ijk]) -> Vec<bool> {
        nodes.par_iter().with_min_len(1 << 10).map(|&node| self.contains(node)).collect()
    }

    /// Whether one of the blocks holds a node.
    pub fn contains(&self, node: Ijk) -> bool {
        if let Ok(n) = self.blocks.binary_search(&block(node)) {
            let number = number_in_block(node);
            return self.masks[n][number >> 6] >> (number & 63) & 1 == 1;
        }
        self.larger.iter().any(|(side, origins)| {
            let origin = Ijk(node.0.map(|x| x & !(side - 1)));
            origins.binary_search(&origin).is_ok()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_inside_when_a_block_holds_it() {
        let blocks = [
            (Ijk::new(-8, 0, 0), 8),
            (Ijk::new(-64, 64, 0), 64),
            (Ijk::new(16, 0, 0), 8),
            (Ijk::new(32, 16, 48), 16),
            (Ijk::new(128, -256, 0), 128),
        ];
        let inside = InsideBlocks::new(&blocks);
        let within =
            [[-1, 7, 0], [-8, 0, 7], [-64, 64, 0], [-1, 127, 63], [16, 3, 3], [32, 16, 48], [47, 31, 63]];
        for node in within.into_iter().chain([[128, -256, 0], [255, -129, 127]]) {
            assert!(inside.contains(Ijk(node)), "{node:?}");
        }
        let beyond =
            [[0, 0, 0], [-9, 0, 0], [-1, 63, 0], [-1, 128, 0], [24, 0, 0], [48, 31, 63], [32, 32, 48]];
        for node in beyond.into_iter().chain([[127, -256, 0], [128, -128, 0]]) {
            assert!(!inside.contains(Ijk(node)), "{node:?}");
        }
    }
}
