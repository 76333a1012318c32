//! Where a leaf is, by its origin: a sorted list of blocks of 8^3 leaves, each with a table.

use super::{Ijk, LEAF_DIM};

/// Leaves along one side of a block: a table of 2 kB for each.
const LEAVES: i32 = 8;

/// Nodes along one side of a block.
const BLOCK: i32 = LEAVES * LEAF_DIM;

/// No leaf.
const NONE: u32 = u32::MAX;

/// The numbers of leaves by origin.
#[derive(Clone, Debug, Default)]
pub struct LeafIndex {
    blocks: Vec<Ijk>,
    tables: Vec<[u32; (LEAVES * LEAVES * LEAVES) as usize]>,
}

impl LeafIndex {
    /// Numbers leaves in the given order.
    ///
    /// # Panics
    /// When there are 2^32 - 1 leaves or more.
    pub fn new(origins: &[Ijk]) -> LeafIndex {
        assert!(origins.len() < NONE as usize, "leaves are numbered by 32 bits");
        let mut blocks: Vec<Ijk> = origins.iter().map(|&o| block(o)).collect();
        blocks.sort_unstable();
        blocks.dedup();
        let mut tables = vec![[NONE; (LEAVES * LEAVES * LEAVES) as usize]; blocks.len()];
        for (&origin, n) in origins.iter().zip(0..) {
            let table = blocks.binary_search(&block(origin)).expect("every leaf has a block");
            tables[table][place(origin)] = n;
        }
        LeafIndex { blocks, tables }
    }

    /// The number of the leaf that holds `node`.
    #[inline]
    pub fn get(&self, node: Ijk) -> Option<usize> {
        let table = self.blocks.binary_search(&block(node)).ok()?;
        let n = self.tables[table][place(node)];
        (n != NONE).then_some(n as usize)
    }
}

/// The lowest node of the block that holds `node`.
#[inline]
fn block(node: Ijk) -> Ijk {
    Ijk(node.0.map(|x| x & !(BLOCK - 1)))
}

/// The place in its block's table of the leaf that holds `node`.
#[inline]
fn place(node: Ijk) -> usize {
    let [x, y, z] = node.0.map(|x| ((x & (BLOCK - 1)) / LEAF_DIM) as usize);
    let side = LEAVES as usize;
    (x * side + y) * side + z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_is_found_by_its_origin() {
        let origins: Vec<Ijk> =
            [[0, 0, 0], [-8, 0, 0], [512, -64, 8], [56, 56, 56], [64, 56, 56], [-8, -8, -8]]
                .map(Ijk)
                .to_vec();
        let index = LeafIndex::new(&origins);
        for (n, &origin) in origins.iter().enumerate() {
            assert_eq!(index.get(origin), Some(n));
            assert_eq!(index.get(origin + Ijk([7, 3, 5])), Some(n));
        }
        for node in [[8, 0, 0], [-9, 0, 0], [i32::MAX; 3], [i32::MIN; 3], [511, -64, 8]] {
            assert_eq!(index.get(Ijk(node)), None, "{node:?}");
        }
        assert_eq!(LeafIndex::default().get(Ijk([0; 3])), None);
    }
}
