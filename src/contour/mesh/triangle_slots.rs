//! The triangles of all leaves in one array, each written where it stays.
//!
//! Nearly all edges have two triangles, so only what comes after the few others needs to be moved.

use super::compact::{push_range, shift_ranges, split_slices};

/// Triangles, with the grid edges that they lie around.
#[derive(Debug, Default)]
pub struct TriangleBuffer {
    /// The vertex numbers of each triangle.
    pub vertices: Vec<[u32; 3]>,
    /// The grid edge of each triangle. See [`LeafMesh::edges`](super::LeafMesh::edges).
    pub edges: Vec<u16>,
}

impl TriangleBuffer {
    /// Makes a buffer with `count` slots.
    pub fn with_slots(count: usize) -> TriangleBuffer {
        TriangleBuffer { vertices: vec![[0; 3]; count], edges: vec![0; count] }
    }

    /// Returns the slots in consecutive parts of the given lengths.
    pub fn split(
        &mut self,
        lengths: impl Iterator<Item = usize> + Clone,
    ) -> (Vec<&mut [[u32; 3]]>, Vec<&mut [u16]>) {
        (split_slices(&mut self.vertices, lengths.clone()), split_slices(&mut self.edges, lengths))
    }

    /// Moves the parts together, or apart, so that each has room for its count of triangles.
    ///
    /// Parts with more triangles than slots have no meaningful content then. Returns the start of
    /// each part, and the number of all triangles.
    pub fn close_up(&mut self, slots: impl Iterator<Item = usize>, counts: &[usize]) -> Vec<usize> {
        let mut ends = vec![0; counts.len() + 1];
        let mut moves = Vec::new();
        let mut from = 0;
        for (n, (slots, &count)) in slots.zip(counts).enumerate() {
            let to = ends[n];
            ends[n + 1] = to + count;
            push_range(&mut moves, from..from + count.min(slots), to);
            from += slots;
        }
        let all = ends[counts.len()];
        self.resize(all.max(from));
        shift_ranges(&mut self.vertices, &moves);
        shift_ranges(&mut self.edges, &moves);
        self.resize(all);
        ends
    }

    /// Writes triangles from number `start` on.
    pub fn put(&mut self, start: usize, triangles: &TriangleBuffer) {
        let end = start + triangles.vertices.len();
        self.vertices[start..end].copy_from_slice(&triangles.vertices);
        self.edges[start..end].copy_from_slice(&triangles.edges);
    }

    fn resize(&mut self, count: usize) {
        self.vertices.resize(count, [0; 3]);
        self.edges.resize(count, 0);
    }
}

/// The slots of one leaf, filled in order.
pub struct TriangleSlots<'a> {
    vertices: &'a mut [[u32; 3]],
    edges: &'a mut [u16],
    used: usize,
    /// All triangles of the leaf, once they are more than its slots.
    overflow: Option<TriangleBuffer>,
}

impl<'a> TriangleSlots<'a> {
    /// Makes empty slots from two slices of one length.
    pub fn new(vertices: &'a mut [[u32; 3]], edges: &'a mut [u16]) -> TriangleSlots<'a> {
        TriangleSlots { vertices, edges, used: 0, overflow: None }
    }

    /// Adds triangles around one grid edge.
    #[inline]
    pub fn extend(&mut self, triangles: &[[u32; 3]], edge: u16) {
        let end = self.used + triangles.len();
        if self.overflow.is_none() && end <= self.vertices.len() {
            self.vertices[self.used..end].copy_from_slice(triangles);
            self.edges[self.used..end].fill(edge);
            self.used = end;
            return;
        }
        let all = self.overflow.get_or_insert_with(|| TriangleBuffer {
            vertices: self.vertices[..self.used].to_vec(),
            edges: self.edges[..self.used].to_vec(),
        });
        all.vertices.extend_from_slice(triangles);
        all.edges.resize(all.vertices.len(), edge);
    }

    /// Returns the number of triangles, and all of them where the slots were too few.
    pub fn finish(self) -> (usize, Option<TriangleBuffer>) {
        (self.overflow.as_ref().map_or(self.used, |all| all.vertices.len()), self.overflow)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_with_more_and_with_fewer_triangles_keep_their_order() {
        // By leaf its slots and its triangles.
        for leaves in [
            vec![(2, 2), (4, 4)],
            vec![(4, 2), (2, 6), (0, 0), (2, 2), (6, 1), (2, 9), (4, 4)],
            vec![(2, 8), (2, 0), (2, 0), (2, 0), (4, 4)],
            vec![(6, 0), (2, 4), (2, 2), (4, 12)],
        ] {
            let slots = leaves.iter().map(|l| l.0);
            let mut triangles = TriangleBuffer::with_slots(slots.clone().sum());
            let (vertices, edges) = triangles.split(slots.clone());
            let mut number = 0;
            let mut done = Vec::new();
            for ((vertices, edges), &(_, count)) in vertices.into_iter().zip(edges).zip(&leaves) {
                let mut slots = TriangleSlots::new(vertices, edges);
                for _ in 0..count {
                    slots.extend(&[[number; 3]], number as u16);
                    number += 1;
                }
                done.push(slots.finish());
            }
            let counts: Vec<usize> = done.iter().map(|d| d.0).collect();
            assert_eq!(counts, leaves.iter().map(|l| l.1).collect::<Vec<_>>());
            let starts = triangles.close_up(slots, &counts);
            for (start, (_, own)) in starts.iter().zip(done) {
                if let Some(own) = own {
                    triangles.put(*start, &own);
                }
            }
            assert_eq!(triangles.vertices, (0..number).map(|n| [n; 3]).collect::<Vec<_>>(), "{leaves:?}");
            assert_eq!(triangles.edges, (0..number as u16).collect::<Vec<_>>());
        }
    }
}
