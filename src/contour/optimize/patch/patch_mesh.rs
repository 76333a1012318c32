//! The triangles of a patch, found by number, vertex and position.

use super::bounds::Bounds;
use super::index::{HalfedgeIndex, TriangleBoxes};
use super::triangle::{Homes, PatchEdge, PatchTriangle};
use crate::contour::mesh::Changes;

/// The vertices of a removed triangle: no vertex has this number.
const REMOVED: [u32; 3] = [u32::MAX; 3];

/// The number of triangles that most patches have room for. Twice as many are no harm.
const PATCH_CAPACITY: usize = 1024;

/// A part of an embedded mesh.
#[derive(Debug)]
pub struct Patch {
    /// The part of space in which changes may be made.
    pub(super) bounds: Bounds,
    /// The boxes that the triangles of each leaf may not leave.
    pub(super) homes: Homes,
    pub(super) triangles: Vec<PatchTriangle>,
    /// The triangles by vertex.
    pub(super) halfedges: HalfedgeIndex,
    /// The triangles by position.
    pub(super) boxes: TriangleBoxes,
    /// The changes so far.
    pub changes: Changes,
}

impl Patch {
    /// Makes a patch without triangles.
    pub fn new(bounds: Bounds, homes: Homes) -> Patch {
        Patch {
            bounds,
            homes,
            triangles: Vec::with_capacity(PATCH_CAPACITY),
            halfedges: HalfedgeIndex::with_capacity(PATCH_CAPACITY),
            boxes: TriangleBoxes::with_capacity(PATCH_CAPACITY),
            changes: Changes::default(),
        }
    }

    /// Adds triangle `number` of the mesh, of the home with number `home`, if its box meets the
    /// bounds. All such triangles must be added before the first change.
    #[inline]
    pub fn add(&mut self, number: usize, vertices: &[u32; 3], corners: &[[f64; 3]; 3], home: u8) {
        let around = Bounds::of_triangle(*corners);
        if around.meets(&self.bounds) {
            self.push(PatchTriangle { number, vertices: *vertices, corners: *corners, home }, around);
        }
    }

    /// Replaces triangles by number, or adds those with the next numbers.
    pub(super) fn put(&mut self, changed: &[(usize, PatchTriangle)]) {
        for &(n, triangle) in changed {
            if n < self.triangles.len() {
                self.halfedges.replace(n, self.triangles[n].vertices, triangle.vertices);
                self.triangles[n] = triangle;
                self.boxes.replace(n, triangle.bounds());
            } else {
                self.push(triangle, triangle.bounds());
            }
        }
    }

    /// Whether triangle `n` of the patch was removed.
    pub fn is_gone(&self, n: usize) -> bool {
        self.triangles[n].vertices == REMOVED
    }

    /// Removes a triangle. The numbers of the others stay.
    pub(super) fn remove(&mut self, n: usize) {
        let nothing =
            PatchTriangle { number: usize::MAX, vertices: REMOVED, corners: [[f64::NAN; 3]; 3], home: 0 };
        self.halfedges.remove(n, self.triangles[n].vertices);
        self.triangles[n] = nothing;
        self.boxes.replace(n, Bounds::NOTHING);
    }

    #[inline]
    fn push(&mut self, triangle: PatchTriangle, bounds: Bounds) {
        self.triangles.push(triangle);
        self.halfedges.push(triangle.vertices);
        self.boxes.push(bounds);
    }

    /// Returns the triangle with number `n` in the patch.
    pub fn triangle_at(&self, n: usize) -> &PatchTriangle {
        &self.triangles[n]
    }

    /// Returns the numbers in the patch of the triangles with the given numbers of the mesh, which
    /// ascend.
    pub fn numbered(&self, numbers: &[usize]) -> Vec<usize> {
        let is_one = |n: &usize| numbers.binary_search(&self.triangles[*n].number).is_ok();
        (0..self.triangles.len()).filter(is_one).collect()
    }

    /// Returns the numbers in the patch of the triangles at a vertex, ascending.
    pub fn star(&self, vertex: u32) -> Vec<usize> {
        let mut star: Vec<usize> = self.halfedges.of(vertex).map(|(n, _)| n).collect();
        star.sort_unstable();
        star
    }

    /// Returns the position of a vertex of the patch.
    pub fn position(&self, vertex: u32) -> Option<[f64; 3]> {
        self.halfedges.of(vertex).next().map(|(n, k)| self.triangles[n].corners[k])
    }

    /// Whether a vertex lies within `radius`, in model units, of `p`.
    pub fn is_taken(&self, p: [f64; 3], radius: f64) -> bool {
        let near =
            |q: [f64; 3]| (0..3).map(|a| (q[a] - p[a]) * (q[a] - p[a])).sum::<f64>() <= radius * radius;
        let around = Bounds::around([p]).grown(radius);
        let mut triangles = self.boxes.near(&around).map(|n| &self.triangles[n]);
        triangles.any(|t| t.corners.into_iter().any(near))
    }

    /// Returns the vertices within `radius` of `p`, by number, with the squares of their distances.
    pub fn vertices_near(&self, p: [f64; 3], radius: f64) -> Vec<(u32, f64)> {
        let distance2 = |q: [f64; 3]| (0..3).map(|a| (q[a] - p[a]) * (q[a] - p[a])).sum::<f64>();
        let around = Bounds::around([p]).grown(radius);
        let near = self.boxes.near(&around).map(|n| &self.triangles[n]);
        let corners = near.flat_map(|t| t.vertices.into_iter().zip(t.corners));
        let mut all: Vec<(u32, f64)> =
            corners.map(|(v, q)| (v, distance2(q))).filter(|(_, d)| *d <= radius * radius).collect();
        all.sort_unstable_by_key(|(v, _)| *v);
        all.dedup_by_key(|(v, _)| *v);
        all
    }

    /// Returns the edges at a vertex and the edges opposite to it, with both their triangles.
    pub fn edges_around(&self, vertex: u32) -> Vec<PatchEdge> {
        let star = self.star(vertex);
        let mut edges = Vec::with_capacity(2 * star.len());
        for n in star {
            let Some(k) = self.triangles[n].corner_of(vertex) else { continue };
            // The edge from the vertex on, and the opposite one: each edge once.
            for k in [k, (k + 1) % 3] {
                edges.extend(self.edge(n, k));
            }
        }
        edges
    }

    /// Whether two vertices have an edge.
    pub(super) fn are_neighbours(&self, a: u32, b: u32) -> bool {
        self.halfedges.of(a).any(|(n, _)| self.triangles[n].vertices.contains(&b))
    }

    /// Returns edge `k` of triangle `n`, 0 to 2, with the triangle beyond it.
    pub fn edge(&self, n: usize, k: usize) -> Option<PatchEdge> {
        let t = &self.triangles[n];
        let corner = |k: usize| (t.vertices[k % 3], t.corners[k % 3]);
        let (a, b, c) = (corner(k), corner(k + 1), corner(k + 2));
        let is_beyond = |&(m, k): &(usize, usize)| self.triangles[m].vertices[(k + 1) % 3] == a.0;
        let (m, k) = self.halfedges.of(b.0).find(is_beyond)?;
        let other = &self.triangles[m];
        let d = (other.vertices[(k + 2) % 3], other.corners[(k + 2) % 3]);
        Some(PatchEdge { triangles: [n, m], a, b, c, d })
    }
}
