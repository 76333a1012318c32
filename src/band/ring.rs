//! The ring of leaves around the leaves of a band, by bit masks of blocks of leaves.

use crate::lattice::leaf_index::{BLOCK_DIM, blocks_of, find, number_in_block};
use crate::lattice::{Axis, Ijk, LEAF_DIM, LeafMask, Z_FIRST, Z_LAST, bits};
use rayon::prelude::*;

/// A set of leaves: the blocks with leaves of the set, ascending, each with a bit for every leaf.
/// Leaves are numbered in a block as nodes are in a leaf.
type LeafSet = Vec<(Ijk, LeafMask)>;

/// Returns the leaves at `origins` and all leaves that touch one of them, if only at a corner,
/// ascending.
pub fn with_ring(origins: &[Ijk]) -> Vec<Ijk> {
    let blocks = blocks_of(origins.iter().copied());
    let mut set: LeafSet = blocks.iter().map(|&block| (block, [0; 8])).collect();
    let mut at = 0;
    for &origin in origins {
        let number = number_in_block(origin);
        set[find(&blocks, &mut at, origin)].1[number >> 6] |= 1 << (number & 63);
    }
    for axis in Axis::ALL {
        set = widened(&set, axis);
    }
    let leaf = |block: Ijk, number: usize| {
        let Ijk(local) = Ijk::in_leaf(Ijk::default(), number);
        block + Ijk(local.map(|x| LEAF_DIM * x))
    };
    let mut all: Vec<Ijk> = Vec::with_capacity(set.iter().map(|(_, mask)| count(mask)).sum());
    for (block, mask) in &set {
        all.extend(bits(mask).map(|number| leaf(*block, number)));
    }
    all.par_sort_unstable();
    all
}

fn count(mask: &LeafMask) -> usize {
    mask.iter().map(|word| word.count_ones() as usize).sum()
}

/// Returns the set with the leaves before and after each leaf along `axis` added.
fn widened(set: &LeafSet, axis: Axis) -> LeafSet {
    let mut step = [0; 3];
    step[axis as usize] = BLOCK_DIM;
    let mut parts: LeafSet = Vec::with_capacity(3 * set.len());
    for &(block, m) in set {
        let (mut before, own, mut after): (_, LeafMask, _) = match axis {
            Axis::X => ([0; 8], std::array::from_fn(|x| m[x.max(1) - 1] | m[x] | m[(x + 1).min(7)]), [0; 8]),
            Axis::Y => (m.map(|w| w << 56), m.map(|w| w << 8 | w | w >> 8), m.map(|w| w >> 56)),
            Axis::Z => (
                m.map(|w| (w & Z_FIRST) << 7),
                m.map(|w| (w & !Z_LAST) << 1 | w | (w & !Z_FIRST) >> 1),
                m.map(|w| (w & Z_LAST) >> 7),
            ),
        };
        if axis == Axis::X {
            (before[7], after[0]) = (m[0], m[7]);
        }
        let beyond = [(block - Ijk(step), before), (block + Ijk(step), after)];
        parts.push((block, own));
        parts.extend(beyond.into_iter().filter(|(_, mask)| *mask != [0; 8]));
    }
    parts.sort_unstable_by_key(|part| part.0);
    parts.dedup_by(|part, all| {
        let is_same = part.0 == all.0;
        if is_same {
            all.1 = std::array::from_fn(|x| all.1[x] | part.1[x]);
        }
        is_same
    });
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_is_what_touches() {
        let origins: Vec<Ijk> =
            [[0, 0, 0], [8, 8, 8], [56, -8, 0], [-64, 56, 120], [512, 504, 8]].map(Ijk).to_vec();
        let mut expected: Vec<Ijk> = origins
            .iter()
            .flat_map(|&o| {
                (0..27).map(move |n| o + Ijk([n / 9, n / 3 % 3, n % 3].map(|d| LEAF_DIM * (d - 1))))
            })
            .collect();
        expected.sort_unstable();
        expected.dedup();
        assert_eq!(with_ring(&origins), expected);
        assert!(with_ring(&[]).is_empty());
        // All leaves of a block.
        let of_block = |n: i32| Ijk([n / 64, n / 8 % 8, n % 8].map(|x| LEAF_DIM * x));
        assert_eq!(with_ring(&(0..512).map(of_block).collect::<Vec<_>>()).len(), 1000);
    }
}
