//! Nodes that are alone on their side of the surface although they are part of a larger body.
//!
//! The tip of a corner can hold a node whose six neighbours lie outside. The contour would make a
//! body of its own of it, a hair away from the body that it is the tip of:
//!
//! ```text
//!      outside   .      outside
//!               / \
//!      outside / o \    outside
//!    ---------/     \---------
//!      o        o        o
//! ```
//!
//! The tip's node touches the others across the diagonal of a cell only. It changes sides, and the
//! contour finds the corner from the cells beside it, like all corners that lie outside of the
//! cells that see them.
//!
//! A node that is all that there is of a small part stays: no other node of its side can be reached
//! from it.

use super::signs::{LeafId, SignField};
use crate::distance::SignedDistance;
use crate::lattice::{Ijk, Lattice, LeafMask, Slab, Z_FIRST, Z_LAST, bits};
use crate::run::SHARE;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::AddAssign;
use std::sync::LazyLock;

/// Length, in voxels, that a tip may reach beyond its node, away from the other node and to the
/// sides. Tips of boxes end within 0.3 and are found again from the cells beside them. Claws and
/// the borders of sheets reach farther, and would be lost.
const MAX_TIP_LENGTH: f64 = 0.5;

/// Cosine with the way to the other node below which a direction is away from that node.
const MAX_COSINE_AWAY: f64 = -0.2;

/// The 26 neighbours of a node: across a face of its cells first, then across an edge, then across
/// a corner.
///
/// The other nodes of a body with a corner as sharp as a box's are among them, at any rotation: the
/// cone in such a corner is 35 degrees wide to each side, and no direction is farther than 28
/// degrees from all neighbours.
static NEIGHBOURS: LazyLock<[[i32; 3]; 26]> = LazyLock::new(|| {
    let mut around: Vec<[i32; 3]> =
        (0..27).map(|n| [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1]).filter(|d| *d != [0; 3]).collect();
    around.sort_by_key(|d| d.iter().map(|x| x.abs()).sum::<i32>());
    around.try_into().expect("27 less the middle")
});

/// Number of other nodes that the way is tried to at most, the nearest first.
const MAX_TRIED: usize = 8;

/// Number of equal parts of the way to another node. At the end of each part, the sign is that of
/// the node.
const WAY_PARTS: i32 = 8;

/// Counts of lone nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LoneNodes {
    /// Number of lone nodes that changed sides.
    pub joined: u64,
    /// Number of lone nodes that make a body, or a cavity, of their own.
    pub alone: u64,
}

impl AddAssign for LoneNodes {
    fn add_assign(&mut self, other: LoneNodes) {
        self.joined += other.joined;
        self.alone += other.alone;
    }
}

/// Moves lone nodes of a larger body to the other side, on the current rayon pool. Returns the
/// counts of nodes that `slab` owns.
pub fn join_lone_nodes(
    signs: &mut SignField,
    distance: &SignedDistance,
    r: f64,
    lattice: Lattice,
    slab: Slab,
) -> LoneNodes {
    let field = &*signs;
    let leaves: Vec<LeafId> = field.leaves().collect();
    let all = || leaves.par_iter().with_min_len(16).with_max_len(SHARE);
    let lone: Vec<LeafMask> = all().map(|&leaf| lone_in(field, leaf)).collect();
    let search = Search { signs: field, lone: &lone, distance, r, lattice };
    let joined: Vec<(LeafId, LeafMask)> = all()
        .filter(|leaf| lone[leaf.0 as usize] != [0; 8])
        .map(|&leaf| (leaf, search.joining(leaf)))
        .collect();
    let count = |mask: &LeafMask| mask.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
    let mut counts = LoneNodes::default();
    for (leaf, joined) in joined {
        if slab.owns(signs.origin(leaf)) {
            counts.joined += count(&joined);
            counts.alone += count(&lone[leaf.0 as usize]) - count(&joined);
        }
        signs.change_sides(leaf, &joined);
    }
    counts
}

/// Whether a node is in a mask.
fn is_in(mask: &LeafMask, number: usize) -> bool {
    mask[number >> 6] >> (number & 63) & 1 == 1
}

/// The search for the body that a lone node belongs to.
struct Search<'a> {
    signs: &'a SignField,
    /// Lone nodes of each leaf.
    lone: &'a [LeafMask],
    distance: &'a SignedDistance<'a>,
    r: f64,
    lattice: Lattice,
}

impl Search<'_> {
    /// Returns the lone nodes of a leaf that are the tip of a larger body.
    fn joining(&self, leaf: LeafId) -> LeafMask {
        let mut joining = [0; 8];
        for number in bits(&self.lone[leaf.0 as usize]).filter(|&number| self.is_tip(leaf, number)) {
            joining[number >> 6] |= 1 << (number & 63);
        }
        joining
    }

    /// Whether the solid reaches from a node to another node of its side that is not alone, and
    /// hardly farther than the node elsewhere.
    fn is_tip(&self, leaf: LeafId, number: usize) -> bool {
        let local = Ijk::in_leaf(Ijk::default(), number);
        let side = is_in(self.signs.inside(leaf), number);
        let is_other = |delta: &&[i32; 3]| {
            self.signs.locate(leaf, (local + Ijk(**delta)).0).is_some_and(|(leaf, number)| {
                is_in(self.signs.inside(leaf), number) == side && !is_in(&self.lone[leaf.0 as usize], number)
            })
        };
        let voxel = self.lattice.voxel;
        let node = DVec3::from(self.lattice.world_from_index(self.signs.origin(leaf) + local));
        let is_on_side = |p: DVec3| (self.distance.at(p, 0).distance - self.r < 0.0) == side;
        let towards = |delta: &[i32; 3]| DVec3::from(delta.map(f64::from));
        let reaches = |delta: &[i32; 3]| {
            let way = towards(delta);
            let goes_on = |other: &[i32; 3]| {
                let direction = towards(other).normalize();
                direction.dot(way.normalize()) <= MAX_COSINE_AWAY
                    && is_on_side(node + MAX_TIP_LENGTH * voxel * direction)
            };
            let is_between = |n: i32| is_on_side(node + f64::from(n) / f64::from(WAY_PARTS) * voxel * way);
            !NEIGHBOURS.iter().any(goes_on) && (1..WAY_PARTS).all(is_between)
        };
        NEIGHBOURS.iter().filter(is_other).take(MAX_TRIED).any(reaches)
    }
}

/// Returns the nodes of a leaf whose six neighbours are all on the other side. Where the field
/// ends, neighbours count as being on the same side.
fn lone_in(signs: &SignField, leaf: LeafId) -> LeafMask {
    let own = signs.inside(leaf);
    if *own == [0; 8] || *own == [!0; 8] {
        // Whole leaves have neighbours of their own.
        return [0; 8];
    }
    let beside = |delta: [i32; 3]| signs.neighbour(leaf, delta).map(|n| signs.inside(n));
    let around = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]].map(beside);
    std::array::from_fn(|x| {
        let word = own[x];
        let layer = |n: usize, at: usize| around[n].map(|mask| mask[at]);
        // The word of the next layer, of the next row and of the next node, and what comes there
        // from the next leaf.
        let low_x = if x > 0 { Some(own[x - 1]) } else { layer(0, 7) };
        let high_x = if x < 7 { Some(own[x + 1]) } else { layer(1, 0) };
        let low_y = layer(2, x).map(|other| word << 8 | other >> 56);
        let high_y = layer(3, x).map(|other| word >> 8 | other << 56);
        let low_z = layer(4, x).map(|other| (word << 1 & !Z_FIRST) | (other & Z_LAST) >> 7);
        let high_z = layer(5, x).map(|other| (word >> 1 & !Z_LAST) | (other & Z_FIRST) << 7);
        let differs = [low_x, high_x, low_y, high_y, low_z, high_z].map(|next| next.map_or(0, |n| word ^ n));
        differs.into_iter().fold(!0, |all, one| all & one)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{LEAF_DIM, LEAF_SIZE};
    use crate::mesh::{Topology, shapes};
    use std::convert::Infallible;

    fn field(rule: impl Fn(Ijk) -> bool) -> SignField {
        let origins: Vec<Ijk> =
            (0..27).map(|n| Ijk([n / 9, n / 3 % 3, n % 3].map(|d| LEAF_DIM * (d - 1)))).collect();
        let mask = |origin: &Ijk| {
            let mut mask = [0; 8];
            for n in (0..LEAF_SIZE).filter(|&n| rule(Ijk::in_leaf(*origin, n))) {
                mask[n >> 6] |= 1 << (n & 63);
            }
            mask
        };
        let masks: Vec<LeafMask> = origins.iter().map(mask).collect();
        SignField::new(&origins, &masks, Slab::WHOLE, |ring| Ok::<_, Infallible>(vec![false; ring.len()]))
            .unwrap()
    }

    #[test]
    fn lone_nodes_are_those_without_a_neighbour_on_their_side() {
        // Scrambled, so that every word and shift is exercised; uniform beside the ring.
        let rule = |n: Ijk| {
            let [i, j, k] = n.0;
            let scrambled = (i * 7 + j * 13 + k * 29 + i * j * k).rem_euclid(11) < 2;
            n.0.iter().all(|&x| (-8..16).contains(&x)) && scrambled
        };
        let field = field(rule);
        let mut count = 0;
        for leaf in field.leaves() {
            let lone = lone_in(&field, leaf);
            for number in 0..LEAF_SIZE {
                let node = Ijk::in_leaf(field.origin(leaf), number);
                let neighbours = (0..6).map(|n| {
                    let mut at = node;
                    at.0[n / 2] += if n % 2 == 0 { 1 } else { -1 };
                    at
                });
                let expected = neighbours.filter(|&at| rule(at) == rule(node)).count() == 0;
                assert_eq!(lone[number >> 6] >> (number & 63) & 1 == 1, expected, "{node:?}");
                count += u32::from(expected);
            }
        }
        assert!(count > 100, "{count}");
    }

    #[test]
    fn a_tip_changes_sides_and_a_small_part_does_not() {
        // A cube of half-side 0.8 whose last layer of nodes is taken for outside but for a corner,
        // and a node far away.
        let mesh = shapes::cube(1);
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        let lattice = Lattice { voxel: 0.25 };
        let (tip, part) = (Ijk::new(3, 3, 3), Ijk::new(9, 9, 9));
        let mut signs = field(|n| n.0.iter().all(|x| x.abs() <= 2) || n == tip || n == part);
        let counts = join_lone_nodes(&mut signs, &distance, -0.2, lattice, Slab::WHOLE);
        assert_eq!(counts, LoneNodes { joined: 1, alone: 1 });
        let is_inside = |node: Ijk| {
            let leaf = signs.leaves().find(|&l| signs.origin(l) == node.leaf_origin()).unwrap();
            let n = node.number_in_leaf();
            signs.inside(leaf)[n >> 6] >> (n & 63) & 1 == 1
        };
        assert!(!is_inside(tip) && is_inside(part) && is_inside(Ijk::new(2, 2, 2)));
    }
}
