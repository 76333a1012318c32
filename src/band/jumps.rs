//! Leaves where the sign of the distance jumps far from the surface.
//!
//! The sign jumps when the input is not closed, or intersects itself. The offset solid is closed
//! along the jump.

use super::{BandSettings, LeafBatch};
use crate::candidates::BlockLists;
use crate::lattice::{Ijk, LEAF_DIM, LEAF_SIZE, LeafIndex};
use rayon::prelude::*;

/// Returns the uniform inside leaves that touch, across a face, a region which is outside as a
/// whole. Without them the sign change between the two would lie in no leaf.
///
/// `leaves` are the leaves of the band, `inside_blocks` the blocks that it found inside as a whole.
/// `is_inside` says whether a node of no leaf is inside. Runs on the current rayon pool.
pub fn leaves_at_jumps(
    leaves: &[Ijk],
    inside_blocks: &[(Ijk, i32)],
    settings: &BandSettings,
    is_inside: impl Fn(Ijk) -> bool + Sync,
) -> LeafBatch {
    let leaves = LeafIndex::new(leaves);
    let is_at_jump = |&(leaf, neighbour): &(Ijk, Ijk)| {
        // Beyond what is computed, nothing is known.
        let is_computed = [leaf, neighbour].iter().all(|&l| settings.slab.computes(l, LEAF_DIM));
        is_computed && leaves.get(neighbour).is_none() && !is_inside(neighbour)
    };
    let mut origins: Vec<Ijk> = inside_blocks
        .par_iter()
        .with_min_len(16)
        .flat_map_iter(|&(origin, side)| border(origin, side).filter(is_at_jump).map(|(leaf, _)| leaf))
        .collect();
    origins.sort_unstable();
    origins.dedup();
    let (count, background) = (origins.len(), settings.background());
    LeafBatch {
        origins,
        values: vec![-background; count * LEAF_SIZE],
        active: vec![[0; 8]; count],
        inside: vec![[!0; 8]; count],
        closest: vec![-1; count * LEAF_SIZE],
        inside_blocks: Vec::new(),
        lists: BlockLists::default(),
    }
}

/// Returns the leaves on the six faces of a block, each with its neighbour beyond the face.
fn border(origin: Ijk, side: i32) -> impl Iterator<Item = (Ijk, Ijk)> {
    let n = side / LEAF_DIM;
    (0..3usize).flat_map(move |axis| {
        [(0, -1), (n - 1, 1)].into_iter().flat_map(move |(layer, step)| {
            (0..n * n).map(move |i| {
                let mut at = [0; 3];
                at[axis] = layer;
                at[(axis + 1) % 3] = i / n;
                at[(axis + 2) % 3] = i % n;
                let leaf = origin + Ijk(at.map(|x| x * LEAF_DIM));
                let mut delta = [0; 3];
                delta[axis] = step * LEAF_DIM;
                (leaf, leaf + Ijk(delta))
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Lattice, Slab};

    #[test]
    fn only_faces_towards_the_outside_get_leaves() {
        // A block of 2 x 2 x 2 leaves; everything with x < 0 is outside, the rest inside or in
        // leaves.
        let leaves = [Ijk::new(-8, 0, 0)];
        let settings =
            BandSettings { lattice: Lattice { voxel: 0.5 }, r: 0.0, half_width: 1.0, slab: Slab::WHOLE };
        let batch = leaves_at_jumps(&leaves, &[(Ijk::default(), 16)], &settings, |node| node.0[0] >= 0);
        assert_eq!(batch.origins, [Ijk::new(0, 0, 8), Ijk::new(0, 8, 0), Ijk::new(0, 8, 8)]);
        assert!(batch.values.iter().all(|&v| v == -settings.background()));
    }
}
