//! Edge collapses.
//!
//! ```text
//!      .---c---.            .---c---.
//!     / \ / \ / \          / \  |  / \
//!    .---a---b---.   ->   .---\ | /---.
//!     \ / \ / \ /          \ / \|/ \ /
//!      .---d---.            .---a---.      (d keeps its position)
//! ```
//!
//! The link condition: the neighbours that the two ends have in common are c and d alone, and the
//! component is no tetrahedron. Then the fans of a and of b, each without the two triangles of the
//! edge, are two fans that meet in c and in d only, and close to one fan around the merged vertex;
//! c and d lose a triangle of four or more; no two triangles become the same. The mesh stays closed
//! and 2-manifold, and keeps its genus.

use super::patch_mesh::Patch;
use super::triangle::PatchTriangle;

/// A collapse for which the link condition holds.
struct Collapsed {
    /// The triangles at the vertex that remains, by number.
    star: Vec<(usize, PatchTriangle)>,
    /// The two triangles of the edge.
    removed: [usize; 2],
}

impl Patch {
    /// Collapses an edge to its first end, at the rounded position `to`, if the mesh stays
    /// embedded, closed and 2-manifold. The second end and the two triangles of the edge are
    /// removed then.
    pub fn try_collapse(&mut self, edge: [u32; 2], to: [f64; 3]) -> bool {
        let Some(Collapsed { star, removed }) = self.collapsed(edge, to) else { return false };
        if !self.accepts(&star, &removed) {
            return false;
        }
        let [kept, removed_end] = edge;
        self.put(&star);
        self.changes.moved.push((kept, to));
        self.changes.triangles.extend(star.iter().map(|(_, t)| (t.number, Some(t.vertices))));
        for n in removed {
            self.changes.triangles.push((self.triangles[n].number, None));
            self.remove(n);
        }
        self.changes.removed_vertices.push(removed_end);
        true
    }

    /// Returns the triangles that the vertex would have after [`try_collapse`](Self::try_collapse);
    /// `None` where the link condition does not hold.
    pub fn star_if_collapsed(&self, edge: [u32; 2], to: [f64; 3]) -> Option<Vec<PatchTriangle>> {
        Some(self.collapsed(edge, to)?.star.into_iter().map(|(_, t)| t).collect())
    }

    /// Makes the collapse of an edge, if the link condition holds and the patch has all triangles
    /// at its ends.
    fn collapsed(&self, [kept, removed_end]: [u32; 2], to: [f64; 3]) -> Option<Collapsed> {
        // All triangles at a vertex within the bounds are in the patch.
        let is_whole = |v: u32| self.position(v).is_some_and(|p| self.bounds.holds(p));
        if kept == removed_end || !is_whole(kept) || !is_whole(removed_end) {
            return None;
        }
        let stars = [self.star(kept), self.star(removed_end)];
        let removed: Vec<usize> = stars[0].iter().copied().filter(|n| stars[1].contains(n)).collect();
        let &[first, second] = removed.as_slice() else { return None };
        // A tetrahedron's vertices have three triangles each.
        if self.common_neighbours(&stars) != 2 || stars[0].len() + stars[1].len() <= 6 {
            return None;
        }
        let rest = stars.iter().flatten().copied().filter(|n| !removed.contains(n));
        let moved = rest.map(|n| {
            let mut triangle = self.triangles[n];
            if let Some(k) = triangle.corner_of(kept).or(triangle.corner_of(removed_end)) {
                triangle.vertices[k] = kept;
                triangle.corners[k] = to;
            }
            (n, triangle)
        });
        Some(Collapsed { star: moved.collect(), removed: [first, second] })
    }

    /// Returns the number of neighbours that the middles of two stars have in common.
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
