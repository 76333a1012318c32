//! The triangles of all leaves in one array, each leaf's written where they stay: nearly all edges have two, so that
//! nothing needs to be moved but what comes after the few others.

use super::compact::{move_pieces, push_piece};
use crate::contour::vertex::split;

/// Triangles, with the edges that they lie around.
#[derive(Debug, Default)]
pub struct Triangles {
    /// The numbers of their vertices.
    pub corners: Vec<[u32; 3]>,
    /// See [`LeafMesh::edges`](crate::contour::optimize::LeafMesh::edges).
    pub edges: Vec<u16>,
}

impl Triangles {
    /// With this many slots.
    pub fn with_slots(count: usize) -> Triangles {
        Triangles { corners: vec![[0; 3]; count], edges: vec![0; count] }
    }

    /// The slots in parts of the given lengths.
    pub fn split(
        &mut self,
        lengths: impl Iterator<Item = usize> + Clone,
    ) -> (Vec<&mut [[u32; 3]]>, Vec<&mut [u16]>) {
        (split(&mut self.corners, lengths.clone()), split(&mut self.edges, lengths))
    }

    /// Moves the parts together, or apart, so that each has room for its count. What is in parts with more triangles than
    /// slots means nothing then. Returns where each part begins, and the number of all.
    pub fn close_up(&mut self, slots: impl Iterator<Item = usize>, counts: &[usize]) -> Vec<usize> {
        let mut ends = vec![0; counts.len() + 1];
        let mut moves = Vec::new();
        let mut from = 0;
        for (n, (slots, &count)) in slots.zip(counts).enumerate() {
            let to = ends[n];
            ends[n + 1] = to + count;
            push_piece(&mut moves, from..from + count.min(slots), to);
            from += slots;
        }
        let all = ends[counts.len()];
        self.resize(all.max(from));
        move_pieces(&mut self.corners, &moves);
        move_pieces(&mut self.edges, &moves);
        self.resize(all);
        ends
    }

    /// Writes triangles from number `start` on.
    pub fn put(&mut self, start: usize, triangles: &Triangles) {
        let end = start + triangles.corners.len();
        self.corners[start..end].copy_from_slice(&triangles.corners);
        self.edges[start..end].copy_from_slice(&triangles.edges);
    }

    fn resize(&mut self, count: usize) {
        self.corners.resize(count, [0; 3]);
        self.edges.resize(count, 0);
    }
}

/// The slots of a leaf while they are filled.
pub struct Slots<'a> {
    corners: &'a mut [[u32; 3]],
    edges: &'a mut [u16],
    used: usize,
    /// All triangles, once there are more than slots.
    too_many: Option<Triangles>,
}

impl<'a> Slots<'a> {
    /// Empty ones, as many of both kinds.
    pub fn new(corners: &'a mut [[u32; 3]], edges: &'a mut [u16]) -> Slots<'a> {
        Slots { corners, edges, used: 0, too_many: None }
    }

    /// Adds triangles around one edge.
    #[inline]
    pub fn extend(&mut self, triangles: &[[u32; 3]], edge: u16) {
        let end = self.used + triangles.len();
        if self.too_many.is_none() && end <= self.corners.len() {
            self.corners[self.used..end].copy_from_slice(triangles);
            self.edges[self.used..end].fill(edge);
            self.used = end;
            return;
        }
        let all = self.too_many.get_or_insert_with(|| Triangles {
            corners: self.corners[..self.used].to_vec(),
            edges: self.edges[..self.used].to_vec(),
        });
        all.corners.extend_from_slice(triangles);
        all.edges.resize(all.corners.len(), edge);
    }

    /// The number of triangles, and all of them where they have not found room.
    pub fn finish(self) -> (usize, Option<Triangles>) {
        (self.too_many.as_ref().map_or(self.used, |all| all.corners.len()), self.too_many)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_with_more_and_with_fewer_triangles_keep_their_order() {
        // By leaf its slots and what it has.
        for leaves in [
            vec![(2, 2), (4, 4)],
            vec![(4, 2), (2, 6), (0, 0), (2, 2), (6, 1), (2, 9), (4, 4)],
            vec![(2, 8), (2, 0), (2, 0), (2, 0), (4, 4)],
            vec![(6, 0), (2, 4), (2, 2), (4, 12)],
        ] {
            let slots = leaves.iter().map(|l| l.0);
            let mut triangles = Triangles::with_slots(slots.clone().sum());
            let (corners, edges) = triangles.split(slots.clone());
            let mut number = 0;
            let mut done = Vec::new();
            for ((corners, edges), &(_, count)) in corners.into_iter().zip(edges).zip(&leaves) {
                let mut slots = Slots::new(corners, edges);
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
            assert_eq!(triangles.corners, (0..number).map(|n| [n; 3]).collect::<Vec<_>>(), "{leaves:?}");
            assert_eq!(triangles.edges, (0..number as u16).collect::<Vec<_>>());
        }
    }
}
