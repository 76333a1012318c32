//! Numbers of leaves by origin: a sorted list of blocks of 8^3 leaves, each with a table.

use super::{Ijk, LEAF_DIM};
use rayon::prelude::*;

/// Leaves along one axis of a block. The table of a block takes 2 kB.
const LEAVES_PER_AXIS: i32 = 8;

/// Nodes along one axis of a block.
pub const BLOCK_DIM: i32 = LEAVES_PER_AXIS * LEAF_DIM;

/// The number that stands for no leaf.
pub const NO_LEAF: u32 = u32::MAX;

/// Numbers of a block's leaves, by [`number_in_block`].
type Table = [u32; (LEAVES_PER_AXIS * LEAVES_PER_AXIS * LEAVES_PER_AXIS) as usize];

/// The numbers of leaves by origin.
#[derive(Clone, Debug, Default)]
pub struct LeafIndex {
    blocks: Vec<Ijk>,
    tables: Vec<Table>,
}

impl LeafIndex {
    /// Numbers leaves in the given order.
    ///
    /// # Panics
    /// When there are 2^32 - 1 leaves or more.
    pub fn new(origins: &[Ijk]) -> LeafIndex {
        assert!(origins.len() < NO_LEAF as usize, "leaves are numbered by 32 bits");
        let blocks = blocks_of(origins.iter().copied());
        let mut tables =
            vec![[NO_LEAF; (LEAVES_PER_AXIS * LEAVES_PER_AXIS * LEAVES_PER_AXIS) as usize]; blocks.len()];
        let mut at = 0;
        for (&origin, n) in origins.iter().zip(0..) {
            tables[find(&blocks, &mut at, origin)][number_in_block(origin)] = n;
        }
        LeafIndex { blocks, tables }
    }

    /// Returns the number of the leaf that holds `node`.
    #[inline]
    pub fn get(&self, node: Ijk) -> Option<usize> {
        let table = self.blocks.binary_search(&block(node)).ok()?;
        let n = self.tables[table][number_in_block(node)];
        (n != NO_LEAF).then_some(n as usize)
    }

    /// Returns the numbers of the leaves around each leaf, or `u32::MAX` where there is none.
    ///
    /// `origins` are the leaves that were numbered, in their order. The entry at (dx, dy, dz)
    /// leaves from a leaf, each -1, 0 or 1, is 9 (dx + 1) + 3 (dy + 1) + (dz + 1). Runs on the
    /// current rayon pool.
    pub fn around(&self, origins: &[Ijk]) -> Vec<[u32; 27]> {
        // Indices of the blocks around each block, likewise.
        let blocks: Vec<[u32; 27]> = self
            .blocks
            .par_iter()
            .with_min_len(64)
            .map(|&block| {
                std::array::from_fn(|slot| {
                    let s = slot as i32;
                    let delta = [s / 9 - 1, s / 3 % 3 - 1, s % 3 - 1];
                    let other = block + Ijk(delta.map(|d| BLOCK_DIM * d));
                    self.blocks.binary_search(&other).map_or(NO_LEAF, |n| n as u32)
                })
            })
            .collect();
        let around = |at: &mut usize, &origin: &Ijk| {
            let blocks = &blocks[find(&self.blocks, at, origin)];
            // Along each axis, for each of three leaves: the block that holds it, and the place
            // there.
            let [x, y, z] = origin.0.map(|x| {
                let leaf = (x & (BLOCK_DIM - 1)) / LEAF_DIM;
                [leaf - 1, leaf, leaf + 1].map(|n| {
                    ((n.div_euclid(LEAVES_PER_AXIS) + 1) as usize, (n & (LEAVES_PER_AXIS - 1)) as usize)
                })
            });
            let mut numbers = [NO_LEAF; 27];
            for (slot, number) in numbers.iter_mut().enumerate() {
                let (x, y, z) = (x[slot / 9], y[slot / 3 % 3], z[slot % 3]);
                if let Some(table) = self.tables.get(blocks[9 * x.0 + 3 * y.0 + z.0] as usize) {
                    *number = table[number_of([x.1, y.1, z.1])];
                }
            }
            numbers
        };
        origins.par_iter().with_min_len(256).map_init(|| 0, around).collect()
    }
}

/// Returns the blocks of some leaves, ascending.
pub fn blocks_of(origins: impl Iterator<Item = Ijk>) -> Vec<Ijk> {
    let mut blocks: Vec<Ijk> = Vec::new();
    for block in origins.map(block) {
        // Leaves that follow each other are of one block, mostly.
        if blocks.last() != Some(&block) {
            blocks.push(block);
        }
    }
    blocks.sort_unstable();
    blocks.dedup();
    blocks
}

/// Returns the index, among ascending blocks, of the block that holds `node`, which is one of them.
///
/// `at` is the index that was found last, and is tried first. It is set to the index that is
/// returned.
#[inline]
pub fn find(blocks: &[Ijk], at: &mut usize, node: Ijk) -> usize {
    let block = block(node);
    if blocks[*at] != block {
        *at = blocks.binary_search(&block).expect("every leaf has a block");
    }
    *at
}

/// Returns the lowest node of the block that holds `node`.
#[inline]
pub fn block(node: Ijk) -> Ijk {
    Ijk(node.0.map(|x| x & !(BLOCK_DIM - 1)))
}

/// Returns the number, in its block, of the leaf that holds `node`. Leaves are numbered in a block
/// as nodes are in a leaf.
#[inline]
pub fn number_in_block(node: Ijk) -> usize {
    number_of(node.0.map(|x| ((x & (BLOCK_DIM - 1)) / LEAF_DIM) as usize))
}

#[inline]
fn number_of([x, y, z]: [usize; 3]) -> usize {
    let side = LEAVES_PER_AXIS as usize;
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

    #[test]
    fn leaves_around_are_those_that_are_there() {
        // Across the faces, edges and corners of blocks, and a leaf alone.
        let mut origins: Vec<Ijk> = (0..125)
            .filter(|n| n % 3 != 0)
            .map(|n| Ijk([n / 25, n / 5 % 5, n % 5].map(|x| LEAF_DIM * (x + 5))))
            .collect();
        origins.push(Ijk::new(-800, 0, 0));
        let index = LeafIndex::new(&origins);
        for (&origin, around) in origins.iter().zip(index.around(&origins)) {
            for (n, number) in around.into_iter().enumerate() {
                let delta = [n / 9, n / 3 % 3, n % 3].map(|d| LEAF_DIM * (d as i32 - 1));
                let expected = index.get(origin + Ijk(delta)).map_or(NO_LEAF, |n| n as u32);
                assert_eq!(number, expected, "{origin:?} {delta:?}");
            }
        }
    }
}
