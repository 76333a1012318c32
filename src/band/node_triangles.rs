//! The closest triangles of the band's nodes. One node of seven is in the band, so only those are
//! kept, found by their ranks in bit masks.

use super::{LeafId, SignField};
use crate::candidates::CandidateLists;
use crate::lattice::{Ijk, LEAF_SIZE, LeafMask, bits};

/// The slot of a leaf of the ring.
const RING_LEAF: [u32; 2] = [u32::MAX; 2];

/// The triangles near the edges of the band, as far as they are known.
#[derive(Clone, Debug, Default)]
pub struct NearTriangles {
    /// Closest triangles of the band's nodes.
    pub nodes: NodeTriangles,
    /// All triangles that can be closest to the points of an edge. Without lists the hierarchy is
    /// asked.
    pub lists: Option<CandidateLists>,
}

/// The closest triangles of the band's nodes, by leaf of a [`SignField`].
#[derive(Clone, Debug, Default)]
pub struct NodeTriangles {
    /// Part of each leaf of the field and its number there, or `u32::MAX` twice for a leaf of the
    /// ring.
    slots: Vec<[u32; 2]>,
    /// Parts as they were made. They are not moved together.
    parts: Vec<PartTriangles>,
}

/// The closest triangles of the nodes of some leaves.
#[derive(Clone, Debug, Default)]
pub struct PartTriangles {
    leaves: Vec<LeafSlot>,
    /// Triangles of the nodes in the masks, leaf by leaf.
    ids: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct LeafSlot {
    /// Nodes with a known triangle.
    mask: LeafMask,
    /// Number of such nodes before each word of the mask.
    before: [u16; 8],
    /// Index of the leaf's first triangle in `ids`.
    first: usize,
}

impl PartTriangles {
    /// Packs 512 triangle numbers for each leaf, -1 where none is known.
    ///
    /// # Panics
    /// When there are not 512 for each.
    pub fn new(numbers: &[i32]) -> PartTriangles {
        assert!(numbers.len().is_multiple_of(LEAF_SIZE), "512 triangle numbers per leaf");
        let known = numbers.iter().filter(|&&n| n >= 0).count();
        let mut part = PartTriangles {
            leaves: Vec::with_capacity(numbers.len() / LEAF_SIZE),
            ids: Vec::with_capacity(known),
        };
        for numbers in numbers.chunks_exact(LEAF_SIZE) {
            let mut slot = LeafSlot { mask: [0; 8], before: [0; 8], first: part.ids.len() };
            for (word, numbers) in numbers.chunks_exact(64).enumerate() {
                slot.before[word] = (part.ids.len() - slot.first) as u16;
                slot.mask[word] =
                    numbers.iter().enumerate().fold(0, |mask, (bit, &n)| mask | u64::from(n >= 0) << bit);
                part.ids.extend(numbers.iter().filter_map(|&n| u32::try_from(n).ok()));
            }
            part.leaves.push(slot);
        }
        part
    }
}

impl NodeTriangles {
    /// Combines parts. `parts` holds the triangles of the leaves `origins`, one after the other.
    ///
    /// # Panics
    /// When the numbers of leaves differ.
    pub fn new(signs: &SignField, origins: &[Ijk], parts: Vec<PartTriangles>) -> Self {
        let numbers_in_parts: Vec<[u32; 2]> = (0..)
            .zip(&parts)
            .flat_map(|(part, of)| (0..of.leaves.len() as u32).map(move |number| [part, number]))
            .collect();
        assert_eq!(numbers_in_parts.len(), origins.len(), "triangle numbers for each leaf");
        let mut order: Vec<u32> = (0..origins.len() as u32).collect();
        order.sort_unstable_by_key(|&n| origins[n as usize]);
        // Both lists are sorted by origin now.
        let mut order = order.into_iter().peekable();
        let slots = signs
            .leaves()
            .map(|leaf| {
                let own = order.next_if(|&n| origins[n as usize] == signs.origin(leaf));
                own.map_or(RING_LEAF, |n| numbers_in_parts[n as usize])
            })
            .collect();
        NodeTriangles { slots, parts }
    }

    /// Returns the triangles of a leaf's nodes. `None` for a leaf of the ring.
    #[inline]
    pub fn of_leaf(&self, leaf: LeafId) -> Option<LeafTriangles<'_>> {
        // Without any parts, all triangles are unknown.
        let [part, number] = *self.slots.get(leaf.0 as usize)?;
        let PartTriangles { leaves, ids } = self.parts.get(part as usize)?;
        let slot = &leaves[number as usize];
        let end = leaves.get(number as usize + 1).map_or(ids.len(), |next| next.first);
        Some(LeafTriangles { slot, ids: &ids[slot.first..end] })
    }
}

/// The closest triangles of a leaf's nodes.
#[derive(Clone, Copy, Debug)]
pub struct LeafTriangles<'a> {
    slot: &'a LeafSlot,
    ids: &'a [u32],
}

impl<'a> LeafTriangles<'a> {
    /// Returns the triangle of a node, if it is known.
    #[inline]
    pub fn get(&self, node: usize) -> Option<u32> {
        let (word, bit) = (node >> 6, node & 63);
        let mask = self.slot.mask[word];
        (mask >> bit & 1 == 1).then(|| {
            let below = (mask & ((1 << bit) - 1)).count_ones();
            self.ids[usize::from(self.slot.before[word]) + below as usize]
        })
    }

    /// Returns all known triangles, in the order of the nodes.
    pub fn known(&self) -> &'a [u32] {
        self.ids
    }

    /// Returns a triangle for each of the 512 nodes, -1 where none is known.
    pub fn by_node(&self) -> [i32; LEAF_SIZE] {
        let mut all = [-1; LEAF_SIZE];
        for (node, &id) in bits(&self.slot.mask).zip(self.ids) {
            all[node] = id as i32;
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_found_by_node() {
        let number = |n: usize| if n * n % 7 < 3 { n as i32 } else { -1 };
        let numbers: Vec<i32> =
            (0..3 * LEAF_SIZE).map(|n| if n / LEAF_SIZE == 1 { -1 } else { number(n) }).collect();
        let part = PartTriangles::new(&numbers);
        let triangles = NodeTriangles { slots: vec![[0, 2], RING_LEAF, [0, 0], [0, 1]], parts: vec![part] };
        assert!(triangles.of_leaf(LeafId(1)).is_none() && triangles.of_leaf(LeafId(4)).is_none());
        for (leaf, number) in [(0, 2), (2, 0), (3, 1)] {
            let expected = &numbers[number * LEAF_SIZE..(number + 1) * LEAF_SIZE];
            let found = triangles.of_leaf(LeafId(leaf)).unwrap();
            assert_eq!(found.by_node(), expected);
            assert!((0..LEAF_SIZE).all(|n| found.get(n) == u32::try_from(expected[n]).ok()));
            assert_eq!(found.known().len(), expected.iter().filter(|&&n| n >= 0).count());
        }
    }
}
