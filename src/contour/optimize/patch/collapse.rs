//! Edges merged to a vertex.
//!
//! ```text
//!      .---c---.            .---c---.
//!     / \ / \ / \          / \  |  / \
//!    .---a---b---.   ->   .---\ | /---.
//!     \ / \ / \ /          \ / \|/ \ /
//!      .---d---.            .---a---.      (d keeps its own place)
//! ```
//!
//! The link condition: the neighbours that the two ends have in common are c and d alone, and the
//! component is no tetrahedron. Then the fans of a and of b, each without the two triangles of the
//! edge, are two fans that meet in c and in d only, and close to one fan around the merged vertex;
//! c and d lose a triangle of four or more; no two triangles become the same. The mesh stays closed
//! and 2-manifold, and keeps its genus.

use super::triangle::PatchTriangle;
use super::{Patch, Point};

/// An edge merged to a vertex, where the link condition holds.
struct Merged {
    /// The triangles at the vertex.
    star: Vec<(usize, PatchTriangle)>,
    /// The two triangles of the edge.
    gone: [usize; 2],
}

impl Patch {
    /// Merges the ends of an edge into its first one, at `to`, which must be rounded, if the mesh
    /// stays embedded, and closed and 2-manifold. The second one and the two triangles of the edge
    /// are gone then.
    pub fn try_collapse(&mut self, edge: [u32; 2], to: Point) -> bool {
        let Some(Merged { star, gone }) = self.merged(edge, to) else { return false };
        if !self.accepts(&star, &gone) {
            return false;
        }
        let [kept, lost] = edge;
        self.put(&star);
        self.changes.moved.push((kept, to));
        self.changes.triangles.extend(star.iter().map(|(_, t)| (t.number, Some(t.vertices))));
        for n in gone {
            self.changes.triangles.push((self.triangles[n].number, None));
            self.remove(n);
        }
        self.changes.removed_vertices.push(lost);
        true
    }

    /// The triangles that the vertex would have after [`try_collapse`](Self::try_collapse); `None`
    /// where the link condition does not hold.
    pub fn star_if_collapsed(&self, edge: [u32; 2], to: Point) -> Option<Vec<PatchTriangle>> {
        Some(self.merged(edge, to)?.star.into_iter().map(|(_, t)| t).collect())
    }

    fn merged(&self, [kept, lost]: [u32; 2], to: Point) -> Option<Merged> {
        // All triangles at a vertex within the bounds are in the patch.
        let is_whole = |v: u32| self.position(v).is_some_and(|p| self.bounds.holds(p));
        if kept == lost || !is_whole(kept) || !is_whole(lost) {
            return None;
        }
        let stars = [self.star(kept), self.star(lost)];
        let gone: Vec<usize> = stars[0].iter().copied().filter(|n| stars[1].contains(n)).collect();
        let &[first, second] = gone.as_slice() else { return None };
        // A tetrahedron's vertices have three triangles each.
        if self.common_neighbours(&stars) != 2 || stars[0].len() + stars[1].len() <= 6 {
            return None;
        }
        let rest = stars.iter().flatten().copied().filter(|n| !gone.contains(n));
        let moved = rest.map(|n| {
            let mut triangle = self.triangles[n];
            if let Some(k) = triangle.place(kept).or(triangle.place(lost)) {
                triangle.vertices[k] = kept;
                triangle.corners[k] = to;
            }
            (n, triangle)
        });
        Some(Merged { star: moved.collect(), gone: [first, second] })
    }

    /// How many neighbours the middles of two stars have in common.
    fn common_neighbours(&self, stars: &[Vec<usize>; 2]) -> usize {
        let [a, b] = stars.each_ref().map(|star| {
            let mut all: Vec<u32> = star.iter().flat_map(|&n| self.triangles[n].vertices).collect();
            all.sort_unstable();
            all.dedup();
            all
        });
        // The two middles are in both lists, too, since they are neighbours.
        a.iter().filter(|v| b.binary_search(v).is_ok()).count().saturating_sub(2)
    }
}
