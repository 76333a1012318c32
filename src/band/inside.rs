//! The blocks of nodes that are inside as a whole: all that is known of the inside beyond the leaves.

use crate::lattice::{Ijk, LEAF_DIM};
use rayon::prelude::*;

/// Blocks that do not overlap, by side and origin.
#[derive(Clone, Debug, Default)]
pub struct InsideBlocks {
    /// Per side, a power of two, the origins in ascending order.
    by_side: Vec<(i32, Vec<Ijk>)>,
}

impl InsideBlocks {
    /// From blocks (origin, side) whose sides are powers of two and whose origins are multiples of them.
    pub fn new(blocks: &[(Ijk, i32)]) -> InsideBlocks {
        let mut by_side: Vec<(i32, Vec<Ijk>)> = Vec::new();
        let mut side = LEAF_DIM;
        while blocks.iter().any(|block| block.1 >= side) {
            let mut origins: Vec<Ijk> = blocks.iter().filter(|b| b.1 == side).map(|b| b.0).collect();
            origins.sort_unstable();
            if !origins.is_empty() {
                by_side.push((side, origins));
            }
            side *= 2;
        }
        InsideBlocks { by_side }
    }

    /// Whether each of the nodes lies in one of the blocks.
    pub fn contain(&self, nodes: &[Ijk]) -> Vec<bool> {
        nodes.par_iter().with_min_len(1 << 10).map(|&node| self.contains(node)).collect()
    }

    /// Whether a node lies in one of the blocks.
    pub fn contains(&self, node: Ijk) -> bool {
        self.by_side.iter().any(|(side, origins)| {
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
        let blocks = [(Ijk::new(-8, 0, 0), 8), (Ijk::new(-64, 64, 0), 64), (Ijk::new(16, 0, 0), 8)];
        let inside = InsideBlocks::new(&blocks);
        for node in [[-1, 7, 0], [-8, 0, 7], [-64, 64, 0], [-1, 127, 63], [16, 3, 3]] {
            assert!(inside.contains(Ijk(node)), "{node:?}");
        }
        for node in [[0, 0, 0], [-9, 0, 0], [-1, 63, 0], [-1, 128, 0], [24, 0, 0]] {
            assert!(!inside.contains(Ijk(node)), "{node:?}");
        }
    }
}
