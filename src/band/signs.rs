//! The signs of nodes, inside or outside of the offset solid: the combinatorial part of the band.
//!
//! A [`SignField`] holds one 512-bit mask per leaf. Besides the leaves of the band it holds a ring
//! of uniform leaves around them (all 26 neighbours that the band lacks), so that every cell with a
//! sign change, and every corner of such a cell, lies in some leaf of the field. Nobody has to ask
//! for the sign of a node outside it.

use super::ring::with_ring;
use crate::lattice::leaf_index::NO_LEAF;
use crate::lattice::{Axis, Ijk, LEAF_DIM, LeafIndex, LeafMask, Slab, Z_FIRST, Z_LAST};
use rayon::prelude::*;

/// The number of a leaf within its [`SignField`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LeafId(pub u32);

/// Signs of the nodes of a set of leaves, with neighbours.
#[derive(Clone, Debug, Default)]
pub struct SignField {
    origins: Vec<Ijk>,
    inside: Vec<LeafMask>,
    /// Neighbours of each leaf. The one at offset (dx, dy, dz) has number 9 (dx+1) + 3 (dy+1) +
    /// (dz+1).
    neighbours: Vec<[u32; 27]>,
    /// Slab that is computed. The field ends at its planes, without a ring.
    slab: Slab,
}

fn neighbour_slot(delta: [i32; 3]) -> usize {
    (9 * (delta[0] + 1) + 3 * (delta[1] + 1) + delta[2] + 1) as usize
}

impl SignField {
    /// Returns the field of the leaves given by `origins` and `inside` masks, in any order, no
    /// origin twice. `missing` is asked once for all neighbouring leaves that the band lacks (a
    /// sorted list of their origins): whether each is inside as a whole. Such a leaf is uniform in
    /// every band, since a node next to a sign change is valid (\[LW11\] Definition 1) and thus in
    /// a leaf of the band.
    ///
    /// Where what `slab` computes ends, there is no ring: the field is cut off, and so is the
    /// surface.
    pub fn new<E>(
        origins: &[Ijk],
        inside: &[LeafMask],
        slab: Slab,
        missing: impl FnOnce(&[Ijk]) -> Result<Vec<bool>, E>,
    ) -> Result<Self, E> {
        assert_eq!(origins.len(), inside.len(), "one mask for each leaf");
        let index = LeafIndex::new(origins);
        let mut all = with_ring(origins);
        all.retain(|&origin| slab.computes(origin, LEAF_DIM) || index.get(origin).is_some());
        let own: Vec<Option<usize>> =
            all.par_iter().with_min_len(256).map(|&origin| index.get(origin)).collect();
        let ring: Vec<Ijk> =
            all.iter().zip(&own).filter(|(_, own)| own.is_none()).map(|(&origin, _)| origin).collect();
        assert_eq!(all.len() - ring.len(), origins.len(), "a leaf was given twice");
        let ring_inside = missing(&ring)?;
        assert_eq!(ring.len(), ring_inside.len(), "one sign for each missing leaf");

        let mut of_ring = ring_inside.into_iter();
        // By leaf the number of its mask; uniform ones are numbered on from the others.
        let count = inside.len();
        let of_leaf = |own: Option<usize>| {
            own.or_else(|| of_ring.next().map(|i| count + usize::from(i))).expect("a sign for each")
        };
        let masks: Vec<usize> = own.into_iter().map(of_leaf).collect();
        let mask = |n: usize| inside.get(n).copied().unwrap_or(if n == count { [0; 8] } else { [!0; 8] });
        let inside = masks.into_par_iter().with_min_len(256).map(mask).collect();
        let neighbours = LeafIndex::new(&all).around(&all);
        let origins = all;
        Ok(SignField { origins, inside, neighbours, slab })
    }

    /// Returns the number of leaves, ring included.
    pub fn len(&self) -> usize {
        self.origins.len()
    }

    /// Whether there is no leaf at all.
    pub fn is_empty(&self) -> bool {
        self.origins.is_empty()
    }

    /// Returns all leaves, sorted by origin.
    pub fn leaves(&self) -> impl ExactSizeIterator<Item = LeafId> + Clone + use<> {
        (0..self.origins.len() as u32).map(LeafId)
    }

    /// Returns the lowest node of a leaf.
    pub fn origin(&self, leaf: LeafId) -> Ijk {
        self.origins[leaf.0 as usize]
    }

    /// Returns the number of leaves between a leaf and the plane where the field ends, up to
    /// `most`.
    pub fn depth(&self, leaf: LeafId, most: i32) -> i32 {
        self.slab.depth(self.origin(leaf), most)
    }

    /// Whether the field ends before the first (`step` -1) or after the last (`step` 1) nodes of a
    /// leaf along x, at a border of the slab.
    pub fn is_border(&self, leaf: LeafId, step: i32) -> bool {
        !self.slab.computes(self.origin(leaf) + Ijk::new(step * LEAF_DIM, 0, 0), LEAF_DIM)
    }

    /// Returns the nodes of a leaf that are inside the offset solid (phi < 0).
    pub fn inside(&self, leaf: LeafId) -> &LeafMask {
        &self.inside[leaf.0 as usize]
    }

    /// Moves some nodes of a leaf to the other side of the surface.
    pub(super) fn change_sides(&mut self, leaf: LeafId, nodes: &LeafMask) {
        for (word, change) in self.inside[leaf.0 as usize].iter_mut().zip(nodes) {
            *word ^= change;
        }
    }

    /// Returns the neighbouring leaf `delta` leaves away, each component -1, 0 or 1. `None` beyond
    /// the ring.
    pub fn neighbour(&self, leaf: LeafId, delta: [i32; 3]) -> Option<LeafId> {
        let n = self.neighbours[leaf.0 as usize][neighbour_slot(delta)];
        (n != NO_LEAF).then_some(LeafId(n))
    }

    /// Returns the leaf that holds the node `local`, and the node's number in it. `local` is given
    /// in nodes from the origin of `leaf`, each component in -8..16. `None` beyond the ring.
    pub fn locate(&self, leaf: LeafId, local: [i32; 3]) -> Option<(LeafId, usize)> {
        let neighbour = self.neighbour(leaf, local.map(|x| x >> 3))?;
        Some((neighbour, Ijk(local).number_in_leaf()))
    }

    /// Returns the nodes of `leaf` whose edge along `axis`, to the next node, changes sign. Edges
    /// that leave the field are not counted: beyond the ring nothing changes sign.
    pub fn crossed_edges(&self, leaf: LeafId, axis: Axis) -> LeafMask {
        let own = self.inside(leaf);
        let mut delta = [0; 3];
        delta[axis as usize] = 1;
        let next = match self.neighbour(leaf, delta) {
            Some(n) => *self.inside(n),
            // Repeat the last layer, so that nothing changes there.
            None => match axis {
                Axis::X => [own[7]; 8],
                Axis::Y => own.map(|w| w >> 56),
                Axis::Z => own.map(|w| (w >> 7) & Z_FIRST),
            },
        };
        match axis {
            Axis::X => std::array::from_fn(|x| own[x] ^ if x < 7 { own[x + 1] } else { next[0] }),
            Axis::Y => std::array::from_fn(|x| own[x] ^ ((own[x] >> 8) | (next[x] << 56))),
            Axis::Z => {
                std::array::from_fn(|x| own[x] ^ (((own[x] >> 1) & !Z_LAST) | ((next[x] & Z_FIRST) << 7)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// Returns a field on 3 x 3 x 3 leaves whose nodes are inside by a rule, the ring outside.
    fn field(rule: impl Fn(Ijk) -> bool) -> SignField {
        let mut origins = Vec::new();
        for n in 0..27 {
            origins.push(Ijk([n / 9, n / 3 % 3, n % 3].map(|d| LEAF_DIM * (d - 1))));
        }
        let inside: Vec<LeafMask> = origins
            .iter()
            .map(|&o| {
                let mut mask = [0; 8];
                for n in (0..512).filter(|&n| rule(Ijk::in_leaf(o, n))) {
                    mask[n >> 6] |= 1 << (n & 63);
                }
                mask
            })
            .collect();
        SignField::new(&origins, &inside, Slab::WHOLE, |ring| Ok::<_, Infallible>(vec![false; ring.len()]))
            .unwrap()
    }

    #[test]
    fn crossed_edges_are_the_sign_changes() {
        // A scrambled rule, so that every word and shift is exercised; cut off before the ring.
        let rule = |n: Ijk| {
            let [i, j, k] = n.0;
            n.0.iter().all(|&x| (-8..16).contains(&x))
                && (i * 7 + j * 13 + k * 29 + i * j * k).rem_euclid(5) < 2
        };
        let field = field(rule);
        let mut crossings = 0;
        for leaf in field.leaves() {
            for axis in Axis::ALL {
                let mask = field.crossed_edges(leaf, axis);
                for n in 0..512 {
                    let node = Ijk::in_leaf(field.origin(leaf), n);
                    let crossed = mask[n >> 6] >> (n & 63) & 1 == 1;
                    assert_eq!(crossed, rule(node) != rule(node.next(axis)), "{node:?} {axis:?}");
                    crossings += usize::from(crossed);
                }
            }
        }
        assert!(crossings > 10_000);
    }

    #[test]
    fn nodes_are_located_across_leaves() {
        let field = field(|_| true);
        let leaf = field.leaves().find(|&l| field.origin(l) == Ijk::default()).unwrap();
        for local in [[-1, 0, 3], [8, 15, -8], [7, 7, 7]] {
            let (l, n) = field.locate(leaf, local).unwrap();
            assert_eq!(Ijk::in_leaf(field.origin(l), n), Ijk(local));
        }
    }
}
