//! Moves, splits and flips.

use super::patch_mesh::Patch;
use super::triangle::{OWN_HOME, PatchEdge, PatchTriangle};
use crate::contour::mesh::{NEW_TRIANGLE, NEW_VERTEX};

impl Patch {
    /// Moves a vertex to the rounded position `to`, if the mesh stays embedded.
    pub fn try_move(&mut self, vertex: u32, to: [f64; 3]) -> bool {
        let moved = |n: usize| {
            let mut triangle = self.triangles[n];
            if let Some(k) = triangle.corner_of(vertex) {
                triangle.corners[k] = to;
            }
            (n, triangle)
        };
        let star: Vec<(usize, PatchTriangle)> = self.star(vertex).into_iter().map(moved).collect();
        if !self.accepts(&star, &[]) {
            return false;
        }
        self.put(&star);
        self.changes.moved.push((vertex, to));
        self.changes.triangles.extend(star.iter().map(|(_, t)| (t.number, Some(t.vertices))));
        true
    }

    /// Splits triangle `n` by a new vertex at the rounded position `at`, if the mesh stays
    /// embedded. Returns the vertex's number.
    pub fn try_split_face(&mut self, n: usize, at: [f64; 3]) -> Option<u32> {
        let t = self.triangles[n];
        let new = self.new_vertex()?;
        let corner = |k: usize| (t.vertices[k % 3], t.corners[k % 3]);
        let third = |k: usize| [corner(k), corner(k + 1), (new, at)];
        let next = self.triangles.len();
        let parts = [
            (n, self.reshaped(n, third(0))),
            (next, self.triangle(self.new_triangle(0), third(1))),
            (next + 1, self.triangle(self.new_triangle(1), third(2))),
        ];
        self.insert(&parts, new, at)
    }

    /// Splits an edge by a new vertex at the rounded position `at`, if the mesh stays embedded.
    /// Returns the vertex's number.
    pub fn try_split_edge(&mut self, edge: &PatchEdge, at: [f64; 3]) -> Option<u32> {
        let PatchEdge { triangles: [first, second], a, b, c, d } = *edge;
        let new = self.new_vertex()?;
        let x = (new, at);
        let next = self.triangles.len();
        let parts = [
            (first, self.reshaped(first, [a, x, c])),
            (next, self.triangle(self.new_triangle(0), [x, b, c])),
            (second, self.reshaped(second, [b, x, d])),
            (next + 1, self.triangle(self.new_triangle(1), [x, a, d])),
        ];
        self.insert(&parts, new, at)
    }

    /// Returns the number of the next added vertex.
    fn new_vertex(&self) -> Option<u32> {
        NEW_VERTEX.checked_add(self.changes.new_vertices)
    }

    /// Returns the number of the added triangle `n` from the next one on.
    fn new_triangle(&self, n: usize) -> usize {
        NEW_TRIANGLE + self.changes.new_triangles + n
    }

    /// Returns a triangle of the patch's own leaf.
    fn triangle(&self, number: usize, corners: [(u32, [f64; 3]); 3]) -> PatchTriangle {
        PatchTriangle {
            number,
            vertices: corners.map(|c| c.0),
            corners: corners.map(|c| c.1),
            home: OWN_HOME,
        }
    }

    /// Returns triangle `n` of the patch with other vertices.
    fn reshaped(&self, n: usize, corners: [(u32, [f64; 3]); 3]) -> PatchTriangle {
        let PatchTriangle { number, home, .. } = self.triangles[n];
        PatchTriangle { home, ..self.triangle(number, corners) }
    }

    /// Replaces triangles by `parts`, of which two are new, if the mesh stays embedded.
    fn insert(&mut self, parts: &[(usize, PatchTriangle)], vertex: u32, at: [f64; 3]) -> Option<u32> {
        if !self.accepts(parts, &[]) {
            return None;
        }
        self.put(parts);
        self.changes.new_vertices += 1;
        self.changes.new_triangles += 2;
        self.changes.moved.push((vertex, at));
        self.changes.triangles.extend(parts.iter().map(|(_, t)| (t.number, Some(t.vertices))));
        Some(vertex)
    }

    /// Flips an edge to the other diagonal of its two triangles, if the mesh stays embedded.
    pub fn try_flip(&mut self, edge: &PatchEdge) -> bool {
        let PatchEdge { triangles: [first, second], a, b, c, d } = *edge;
        if self.are_neighbours(c.0, d.0) {
            return false;
        }
        let pair = [(first, self.reshaped(first, [a, d, c])), (second, self.reshaped(second, [d, b, c]))];
        if !self.accepts(&pair, &[]) {
            return false;
        }
        self.put(&pair);
        self.changes.triangles.extend(pair.map(|(_, t)| (t.number, Some(t.vertices))));
        true
    }
}
