//! Slabs: parts of the lattice between two planes of nodes, worked off one after the other or by
//! several machines.
//!
//! A slab owns the leaves between its planes. It computes those around it as well, as far as they
//! bear upon its own part of the result:
//!
//! ```text
//!      from - halo          from                  to          to + halo       nodes along x
//!           |  computed too  |  owned              |  computed too  |
//!           |      L L L L L |  L L L L L L L L L  |  L L L L       |         L: a leaf
//! ```
//!
//! What is owned is the same, to the last bit, as in a run that computes everything: nothing
//! reaches further than the halo. Slabs are cut across x, the slowest axis in the order of leaves,
//! so that what a slab owns is one piece of everything that is kept in this order.

use super::{Ijk, LEAF_DIM};

/// A part of the lattice between two planes of nodes across the x axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slab {
    from: i32,
    to: i32,
    halo: i32,
}

impl Default for Slab {
    fn default() -> Slab {
        Slab::WHOLE
    }
}

impl Slab {
    /// Everything.
    pub const WHOLE: Slab = Slab { from: i32::MIN, to: i32::MAX, halo: 0 };

    /// Returns the leaves from node `from` along x up to but not including node `to`, and `halo`
    /// more nodes on either side that are computed too. All are multiples of 8; `i32::MIN` and
    /// `i32::MAX` stand for no end.
    ///
    /// # Panics
    /// When a plane or the halo is not a multiple of 8.
    pub fn new(from: i32, to: i32, halo: i32) -> Slab {
        let is_plane = |x: i32| x % LEAF_DIM == 0 || x == i32::MAX;
        assert!(is_plane(from) && is_plane(to) && halo % LEAF_DIM == 0, "slabs are made of whole leaves");
        Slab { from, to, halo }
    }

    /// Whether the slab owns the leaf or block at `origin`. Of several slabs that touch, one owns
    /// each leaf.
    pub fn owns(&self, origin: Ijk) -> bool {
        (self.from..self.to).contains(&origin.0[0])
    }

    /// Whether the slab owns any node of the block at `origin` with the given width.
    pub fn meets(&self, origin: Ijk, width: i32) -> bool {
        let x = origin.0[0];
        x < self.to && x.saturating_add(width) > self.from
    }

    /// Returns the number of leaves between the leaf at `origin`, which is computed, and the nearer
    /// one of the planes where the computed part ends. Counts up to `most`.
    pub fn depth(&self, origin: Ijk, most: i32) -> i32 {
        let at = |leaves: i32| origin + Ijk::new(LEAF_DIM * leaves, 0, 0);
        let is_within = |n: &i32| self.computes(at(n + 1), LEAF_DIM) && self.computes(at(-n - 1), LEAF_DIM);
        (0..most).find(|n| !is_within(n)).unwrap_or(most)
    }

    /// Whether any node of the block at `origin` with the given width is computed.
    pub fn computes(&self, origin: Ijk, width: i32) -> bool {
        let x = origin.0[0];
        let first = self.from.saturating_sub(self.halo);
        let end = self.to.saturating_add(self.halo);
        x < end && x.saturating_add(width) > first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_leaf_belongs_to_one_of_several_slabs() {
        let planes = [i32::MIN, -16, 0, 40, i32::MAX];
        let slabs: Vec<Slab> = planes.windows(2).map(|p| Slab::new(p[0], p[1], 16)).collect();
        for x in (-160..160).step_by(8) {
            let leaf = Ijk::new(x, 8, -8);
            assert_eq!(slabs.iter().filter(|s| s.owns(leaf)).count(), 1, "{x}");
        }
        assert!(Slab::WHOLE.owns(Ijk::new(-8, 0, 0)) && Slab::WHOLE.computes(Ijk::new(1 << 30, 0, 0), 8));
    }

    #[test]
    fn the_halo_is_computed_and_not_owned() {
        let slab = Slab::new(0, 40, 16);
        let (computed, owned): (Vec<i32>, Vec<i32>) = (
            (-80..120).step_by(8).filter(|&x| slab.computes(Ijk::new(x, 0, 0), 8)).collect(),
            (-80..120).step_by(8).filter(|&x| slab.owns(Ijk::new(x, 0, 0))).collect(),
        );
        assert_eq!((computed[0], computed[computed.len() - 1]), (-16, 48));
        assert_eq!((owned[0], owned[owned.len() - 1]), (0, 32));
        let depth = |x| slab.depth(Ijk::new(x, 0, 0), 3);
        assert_eq!([-16, -8, 0, 8, 16, 32, 40, 48].map(depth), [0, 1, 2, 3, 3, 2, 1, 0]);
        // A block that reaches in.
        assert!(slab.computes(Ijk::new(-64, 0, 0), 64) && !slab.computes(Ijk::new(-64, 0, 0), 32));
    }
}
