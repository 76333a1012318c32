//! Indices of a patch's triangles: by vertex, and by position.

use super::Bounds;

/// Stands for no vertex and no halfedge.
const NONE: u32 = u32::MAX;

/// The number of slots that most patches have room in: they have some hundred vertices.
const SLOTS: usize = 1024;

/// The halfedges of triangles by the vertex that they start at. A halfedge's number is three times
/// that of its triangle, plus its number there.
///
/// Each vertex has a chain of its halfedges. The heads of the chains are in a table with open
/// addressing, since the vertices of a patch are few numbers out of many.
#[derive(Debug)]
pub struct HalfedgeIndex {
    /// A vertex, and the first of its halfedges; [`NONE`] where the slot is free.
    slots: Vec<(u32, u32)>,
    used: usize,
    /// The next halfedge from the same vertex, by halfedge.
    next: Vec<u32>,
}

impl HalfedgeIndex {
    /// Makes an empty index with room for `triangles`.
    pub fn with_capacity(triangles: usize) -> HalfedgeIndex {
        HalfedgeIndex { slots: vec![(NONE, NONE); SLOTS], used: 0, next: Vec::with_capacity(3 * triangles) }
    }

    /// Returns the slot of a vertex, or the free one where it would be.
    #[inline]
    fn slot(&self, vertex: u32) -> usize {
        // Fibonacci hashing: the highest bits of a product with 2^32 over the golden ratio.
        let shift = 32 - self.slots.len().trailing_zeros();
        let mut slot = (vertex.wrapping_mul(0x9e37_79b9) >> shift) as usize;
        while self.slots[slot].0 != vertex && self.slots[slot].0 != NONE {
            slot = (slot + 1) & (self.slots.len() - 1);
        }
        slot
    }

    /// Returns the triangles at a vertex with the vertex's number in each, 0 to 2, in no order.
    #[inline]
    pub fn of(&self, vertex: u32) -> impl Iterator<Item = (usize, usize)> + '_ {
        let first = self.slots[self.slot(vertex)].1;
        let halfedges =
            std::iter::successors((first != NONE).then_some(first), |&c| match self.next[c as usize] {
                NONE => None,
                next => Some(next),
            });
        halfedges.map(|halfedge| (halfedge as usize / 3, halfedge as usize % 3))
    }

    /// Adds the next triangle.
    #[inline]
    pub fn push(&mut self, vertices: [u32; 3]) {
        let first = self.next.len() as u32;
        self.next.extend([NONE; 3]);
        for (k, vertex) in vertices.into_iter().enumerate() {
            self.link(first + k as u32, vertex);
        }
    }

    /// Replaces the vertices of triangle `n`.
    pub fn replace(&mut self, n: usize, old: [u32; 3], new: [u32; 3]) {
        for k in (0..3).filter(|&k| old[k] != new[k]) {
            let halfedge = (3 * n + k) as u32;
            self.unlink(halfedge, old[k]);
            self.link(halfedge, new[k]);
        }
    }

    /// Removes triangle `n`. The numbers of the others stay.
    pub fn remove(&mut self, n: usize, vertices: [u32; 3]) {
        for (k, vertex) in vertices.into_iter().enumerate() {
            self.unlink((3 * n + k) as u32, vertex);
        }
    }

    #[inline]
    fn link(&mut self, halfedge: u32, vertex: u32) {
        let mut slot = self.slot(vertex);
        if self.slots[slot].0 == NONE {
            // At most half full, so that free slots are near.
            if 2 * (self.used + 1) > self.slots.len() {
                self.grow();
                slot = self.slot(vertex);
            }
            self.used += 1;
        }
        self.next[halfedge as usize] = self.slots[slot].1;
        self.slots[slot] = (vertex, halfedge);
    }

    fn unlink(&mut self, halfedge: u32, vertex: u32) {
        let after = std::mem::replace(&mut self.next[halfedge as usize], NONE);
        let slot = self.slot(vertex);
        let mut at = self.slots[slot].1;
        if at == halfedge {
            // A vertex without halfedges keeps its slot: slots behind it are found through it.
            self.slots[slot].1 = after;
            return;
        }
        while at != NONE {
            let next = self.next[at as usize];
            if next == halfedge {
                self.next[at as usize] = after;
                return;
            }
            at = next;
        }
    }

    #[cold]
    fn grow(&mut self) {
        let larger = vec![(NONE, NONE); 4 * self.slots.len()];
        for entry in std::mem::replace(&mut self.slots, larger) {
            if entry.0 != NONE {
                let slot = self.slot(entry.0);
                self.slots[slot] = entry;
            }
        }
    }
}

/// The number of triangles that have a box in common. Consecutive triangles are near each other,
/// mostly.
const BLOCK: usize = 32;

/// The boxes of triangles, searched in blocks.
#[derive(Debug)]
pub struct TriangleBoxes {
    boxes: Vec<Bounds>,
    /// The box around the boxes of each block, past ones included.
    blocks: Vec<Bounds>,
}

impl TriangleBoxes {
    /// Makes an empty set of boxes with room for `triangles`.
    pub fn with_capacity(triangles: usize) -> TriangleBoxes {
        TriangleBoxes {
            boxes: Vec::with_capacity(triangles),
            blocks: Vec::with_capacity(triangles.div_ceil(BLOCK)),
        }
    }

    /// Returns the box of triangle `n`.
    pub fn of(&self, n: usize) -> &Bounds {
        &self.boxes[n]
    }

    /// Adds the box of the next triangle.
    #[inline]
    pub fn push(&mut self, bounds: Bounds) {
        match self.blocks.last_mut() {
            Some(block) if !self.boxes.len().is_multiple_of(BLOCK) => *block = block.with(&bounds),
            _ => self.blocks.push(bounds),
        }
        self.boxes.push(bounds);
    }

    /// Replaces the box of triangle `n`.
    pub fn replace(&mut self, n: usize, bounds: Bounds) {
        self.boxes[n] = bounds;
        let block = &mut self.blocks[n / BLOCK];
        *block = block.with(&bounds);
    }

    /// Returns the triangles whose boxes meet `bounds`, ascending.
    #[inline]
    pub fn near<'a>(&'a self, bounds: &'a Bounds) -> impl Iterator<Item = usize> + 'a {
        let blocks = self.blocks.iter().enumerate().filter(|(_, block)| block.meets(bounds));
        blocks.flat_map(move |(n, _)| {
            let first = n * BLOCK;
            let boxes = &self.boxes[first..self.boxes.len().min(first + BLOCK)];
            boxes.iter().enumerate().filter(|(_, b)| b.meets(bounds)).map(move |(k, _)| first + k)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halfedges_are_found_after_any_changes() {
        let mut halfedges = HalfedgeIndex::with_capacity(4);
        let mut triangles: Vec<Option<[u32; 3]>> = Vec::new();
        let mut state = 1u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        // Numbers as far apart as those of old and new vertices, and more of them than the table
        // has slots.
        let vertex = |n: u32| if n.is_multiple_of(2) { n } else { n | 1 << 31 };
        for _ in 0..5_000 {
            let first = random(1_500);
            let vertices = [0, 1, 2].map(|k| vertex(first + 7 * k));
            match random(4) {
                0 if !triangles.is_empty() => {
                    let n = random(triangles.len() as u32) as usize;
                    if let Some(old) = triangles[n].replace(vertices) {
                        halfedges.replace(n, old, vertices);
                    } else {
                        triangles[n] = None;
                    }
                }
                1 if !triangles.is_empty() => {
                    let n = random(triangles.len() as u32) as usize;
                    if let Some(old) = triangles[n].take() {
                        halfedges.remove(n, old);
                    }
                }
                _ => {
                    halfedges.push(vertices);
                    triangles.push(Some(vertices));
                }
            }
        }
        for v in (0..1_520).map(vertex) {
            let mut found: Vec<_> = halfedges.of(v).collect();
            found.sort_unstable();
            let there = triangles.iter().enumerate().filter_map(|(n, t)| Some((n, (*t)?)));
            let expected: Vec<_> =
                there.filter_map(|(n, t)| Some((n, t.iter().position(|&w| w == v)?))).collect();
            assert_eq!(found, expected, "vertex {v}");
        }
    }

    #[test]
    fn boxes_are_found_in_their_order() {
        let unit = |x: f64| Bounds { lo: [x, 0.0, 0.0], hi: [x + 1.0, 1.0, 1.0] };
        let mut boxes = TriangleBoxes::with_capacity(1);
        for n in 0..100 {
            boxes.push(unit(f64::from(n)));
        }
        boxes.replace(3, unit(70.5));
        boxes.replace(70, Bounds::NOTHING);
        let found: Vec<usize> = boxes.near(&unit(70.2)).collect();
        assert_eq!(found, [3, 71]);
    }
}
