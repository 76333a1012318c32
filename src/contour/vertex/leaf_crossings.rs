//! The crossings of the edges of a leaf's cells, in a plain array: up to four cells look up each
//! crossing.

use crate::band::{LeafId, SignField};
use crate::contour::cell::Edge;
use crate::edge::{Crossing, Crossings, EdgeId};
use crate::lattice::{Axis, Ijk, LEAF_DIM, bits, facing_layer};

/// The number of nodes along each axis: those of the leaf, and the first ones of the next.
const WIDTH: usize = LEAF_DIM as usize + 1;

/// The number of edges of one axis.
const EDGES: usize = WIDTH * WIDTH * WIDTH;

/// The crossings of all edges of a leaf's cells.
pub struct LeafCrossings<'a> {
    samples: &'a [Crossing],
    /// The numbers of the crossings by axis and lower node, z fastest; `u32::MAX` where there is
    /// none.
    numbers: [u32; 3 * EDGES],
}

/// Returns the index of a node in the array of an axis, from its coordinates in the leaf, 0 to 8
/// each.
#[inline]
const fn index([x, y, z]: [i32; 3]) -> usize {
    (x as usize * WIDTH + y as usize) * WIDTH + z as usize
}

/// The indices of the edges of a cell, counted from the index of its lowest node.
const OF_CELL: [usize; 12] = {
    let mut indices = [0; 12];
    let mut n = 0;
    while n < 12 {
        let axis = Axis::ALL[n / 4];
        let edge = Edge::new(axis, n as u8 & 1, n as u8 >> 1 & 1);
        indices[n] = axis as usize * EDGES + index(edge.low().offset());
        n += 1;
    }
    indices
};

impl<'a> LeafCrossings<'a> {
    /// Collects the crossings of the cells of `leaf`.
    pub fn new(signs: &SignField, crossings: &'a Crossings, leaf: LeafId) -> LeafCrossings<'a> {
        let numbers = &crossings.numbers;
        let mut around = LeafCrossings { samples: &crossings.samples, numbers: [u32::MAX; 3 * EDGES] };
        for ((axis, number), id) in numbers.in_leaf(leaf).zip(numbers.range(leaf)) {
            let local = Ijk::in_leaf(Ijk::default(), number);
            around.numbers[axis as usize * EDGES + index(local.0)] = id;
        }
        for n in 1..8 {
            let delta = [n >> 2, n >> 1 & 1, n & 1];
            let Some(other) = signs.neighbour(leaf, delta) else { continue };
            for axis in Axis::ALL.into_iter().filter(|&axis| delta[axis as usize] == 0) {
                let facing = facing_layer(numbers.mask(other, axis), delta);
                for number in bits(&facing) {
                    let EdgeId(id) = numbers.get(other, axis, number).expect("it is in the mask");
                    let local = Ijk::in_leaf(Ijk(delta.map(|d| LEAF_DIM * d)), number);
                    around.numbers[axis as usize * EDGES + index(local.0)] = id;
                }
            }
        }
        around
    }

    /// Whether all of some edges of the cell at `local` have a crossing.
    #[inline]
    pub fn has_all(&self, local: [i32; 3], mut edges: impl Iterator<Item = Edge>) -> bool {
        edges.all(|edge| self.numbers[index(local) + OF_CELL[edge.index()]] != u32::MAX)
    }

    /// Returns the crossing of an edge of the cell at `local`, 0 to 7 each. The edge must be
    /// crossed.
    #[inline]
    pub fn of_cell(&self, local: [i32; 3], edge: Edge) -> &'a Crossing {
        &self.samples[self.numbers[index(local) + OF_CELL[edge.index()]] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_of_a_cell_start_at_its_corners() {
        for edge in Edge::all() {
            let [x, y, z] = edge.low().offset();
            let axis = edge.axis() as usize;
            assert_eq!(OF_CELL[edge.index()], axis * EDGES + index([x, y, z]), "{edge:?}");
            assert!(index([7 + x, 7 + y, 7 + z]) < EDGES);
        }
    }
}
