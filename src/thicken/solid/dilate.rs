//! Dilation of a set of nodes on the lattice.

use crate::band::{LeafId, SignField};
use crate::lattice::{Axis, LeafMask, Z_FIRST, Z_LAST};
use rayon::prelude::*;

/// Number of nodes that a set grows by along each axis. The contour's faces at an edge take all
/// edges of the four cells around it, and the next faces are there, too: with them, holes and
/// islands of up to five faces are closed.
const STEPS: usize = 3;

/// Returns the nodes at most [`STEPS`] steps along each axis from those of `masks`, leaf by leaf.
pub(super) fn dilate(signs: &SignField, mut masks: Vec<LeafMask>) -> Vec<LeafMask> {
    let leaves: Vec<LeafId> = signs.leaves().collect();
    for axis in Axis::ALL {
        for _ in 0..STEPS {
            let wider = leaves.par_iter().with_min_len(64).map(|&leaf| {
                let neighbour = |step: i32| {
                    let mut delta = [0; 3];
                    delta[axis as usize] = step;
                    signs.neighbour(leaf, delta).map_or([0; 8], |other| masks[other.0 as usize])
                };
                dilate_along(axis, neighbour(-1), masks[leaf.0 as usize], neighbour(1))
            });
            masks = wider.collect();
        }
    }
    masks
}

/// Grows a leaf's mask by one node in both directions of an axis. `before` and `after` are the
/// masks of the neighbouring leaves.
fn dilate_along(axis: Axis, before: LeafMask, own: LeafMask, after: LeafMask) -> LeafMask {
    std::array::from_fn(|x| {
        let [low, word, high] = [before[x], own[x], after[x]];
        word | match axis {
            Axis::X => {
                (if x > 0 { own[x - 1] } else { before[7] }) | if x < 7 { own[x + 1] } else { after[0] }
            }
            Axis::Y => word << 8 | word >> 8 | low >> 56 | high << 56,
            Axis::Z => {
                (word & !Z_LAST) << 1 | (word & !Z_FIRST) >> 1 | (low & Z_LAST) >> 7 | (high & Z_FIRST) << 7
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Ijk, Slab};
    use std::convert::Infallible;

    #[test]
    fn a_node_has_its_neighbours_in_all_leaves() {
        let origins: Vec<Ijk> = (0..27).map(|n| Ijk::new(n / 9 * 8, n / 3 % 3 * 8, n % 3 * 8)).collect();
        let missing = |ring: &[Ijk]| Ok::<_, Infallible>(vec![false; ring.len()]);
        let signs = SignField::new(&origins, &[[0; 8]; 27], Slab::WHOLE, missing).unwrap();
        let bit =
            |mask: &LeafMask, node: Ijk| mask[node.number_in_leaf() >> 6] >> (node.number_in_leaf() & 63) & 1;
        for node in [Ijk::new(8, 15, 11), Ijk::new(12, 8, 15), Ijk::new(10, 13, 8)] {
            let holds = |leaf: LeafId| node.0.map(|x| x & !7) == signs.origin(leaf).0;
            let mut masks = vec![[0; 8]; signs.len()];
            for leaf in signs.leaves().filter(|&leaf| holds(leaf)) {
                let number = node.number_in_leaf();
                masks[leaf.0 as usize][number >> 6] |= 1 << (number & 63);
            }
            let wider = dilate(&signs, masks);
            for leaf in signs.leaves() {
                for number in 0..512 {
                    let other = Ijk::in_leaf(signs.origin(leaf), number);
                    let is_near = (other - node).0.iter().all(|d| d.unsigned_abs() as usize <= STEPS);
                    assert_eq!(bit(&wider[leaf.0 as usize], other) == 1, is_near, "{other:?}");
                }
            }
        }
    }
}
