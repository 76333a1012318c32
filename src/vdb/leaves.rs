//! Checks of leaves and blocks before they cross the bridge.

use super::VdbError;
use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE, LeafMask};

/// Nodes further than this from the origin are refused, so that nothing overflows near the ends of
/// i32.
const FURTHEST: i32 = 1 << 30;

/// The coordinates of nodes as a flat list.
pub(super) fn flat(nodes: &[Ijk]) -> Vec<i32> {
    nodes.iter().flat_map(|n| n.0).collect()
}

/// The nodes in a flat list of coordinates.
pub(super) fn nodes(flat: &[i32]) -> Vec<Ijk> {
    flat.as_chunks::<3>().0.iter().copied().map(Ijk).collect()
}

/// Fails if slices do not hold whole leaves.
pub(super) fn check_lengths(count: usize, values: usize, active: usize) -> Result<(), VdbError> {
    let wrong = |what, expected, found| Err(VdbError::Length { count, what, expected, found });
    if values != count * LEAF_SIZE {
        wrong("values", count * LEAF_SIZE, values)
    } else if active != count {
        wrong("masks", count, active)
    } else {
        Ok(())
    }
}

/// Fails if a block of `side` nodes cannot begin at `origin`.
pub(super) fn check_block(origin: Ijk, side: u32) -> Result<(), VdbError> {
    let wrong = |reason| Err(VdbError::Block { origin, side, reason });
    let end = |x: i32| i64::from(x) + i64::from(side);
    if side == 0 || !side.is_multiple_of(LEAF_DIM as u32) {
        wrong("its side is not a multiple of 8")
    } else if origin != origin.leaf_origin() {
        wrong("the node is not the origin of a leaf")
    } else if origin.0.iter().any(|&x| x < -FURTHEST || end(x) > i64::from(FURTHEST)) {
        wrong("it is too far from the world's origin")
    } else {
        Ok(())
    }
}

/// Returns the fault of leaves' values as parts of a level set, if any: the invariants at the
/// head of [`vdb`](super).
pub(super) fn level_set_fault(
    origins: &[Ijk],
    values: &[f32],
    active: &[LeafMask],
    background: f32,
) -> Option<String> {
    let leaves = origins.iter().zip(values.as_chunks::<LEAF_SIZE>().0).zip(active);
    for ((&origin, values), mask) in leaves {
        for (number, &phi) in values.iter().enumerate() {
            let is_active = mask[number >> 6] >> (number & 63) & 1 == 1;
            let as_it_should = match is_active {
                true => phi != 0.0 && phi.abs() < background,
                false => phi.abs() == background,
            };
            if !as_it_should {
                let state = if is_active { "active" } else { "inactive" };
                let node = Ijk::in_leaf(origin, number).0;
                return Some(format!("{state} node {node:?} has the value {phi}, background {background}"));
            }
        }
    }
    None
}
