//! The working form of the band: leaves in plain arrays, as they cross the bridge to OpenVDB.

use crate::candidates::BlockLists;
use crate::lattice::{Ijk, LEAF_SIZE, LeafMask};

/// A batch of leaves as a structure of arrays.
///
/// Entry n of `values` and `closest` belongs to node n % 512 of leaf n / 512.
#[derive(Clone, Debug, Default)]
pub struct LeafBatch {
    /// Lowest node of each leaf.
    pub origins: Vec<Ijk>,
    /// phi, or plus or minus the background on inactive nodes; 512 per leaf.
    pub values: Vec<f32>,
    /// Nodes with abs(phi) below the background.
    pub active: Vec<LeafMask>,
    /// Nodes with a negative value.
    pub inside: Vec<LeafMask>,
    /// Number of the closest triangle on active nodes, -1 elsewhere; 512 per leaf.
    pub closest: Vec<i32>,
    /// Blocks that are inside as a whole and hold no leaf: origin, and width in nodes, a multiple
    /// of 8.
    pub inside_blocks: Vec<(Ijk, i32)>,
    /// Candidate lists of the leaves, empty where the band was built without lists.
    pub lists: BlockLists,
}

impl LeafBatch {
    /// Returns the number of leaves.
    pub fn len(&self) -> usize {
        self.origins.len()
    }

    /// Copies the data of a level set: no masks of the inside, closest triangles or lists.
    pub fn level_set(&self) -> LeafBatch {
        LeafBatch {
            origins: self.origins.clone(),
            values: self.values.clone(),
            active: self.active.clone(),
            inside_blocks: self.inside_blocks.clone(),
            ..LeafBatch::default()
        }
    }

    /// Removes all leaves and keeps the memory.
    pub fn clear(&mut self) {
        let LeafBatch { origins, values, active, inside, closest, inside_blocks, lists } = self;
        origins.clear();
        values.clear();
        active.clear();
        inside.clear();
        closest.clear();
        inside_blocks.clear();
        lists.clear();
    }

    /// Whether there is no leaf.
    pub fn is_empty(&self) -> bool {
        self.origins.is_empty()
    }
}

/// Returns the nodes of a leaf with a negative value.
pub fn inside_mask(values: &[f32]) -> LeafMask {
    assert_eq!(values.len(), LEAF_SIZE, "a leaf has 512 values");
    std::array::from_fn(|x| {
        values[64 * x..64 * x + 64].iter().enumerate().fold(0, |m, (bit, &v)| m | u64::from(v < 0.0) << bit)
    })
}
