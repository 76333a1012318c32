//! A part of a finished mesh that can be changed without making it intersect itself.
//!
//! The mesh is embedded: triangles meet in the vertices and edges that they share, and nowhere
//! else. A vertex is moved, a triangle or an edge split, an edge flipped or merged to a vertex,
//! only if the triangles that this changes meet no other triangle and not each other, decided by
//! exact predicates on the coordinates as they will be written. Then the mesh is embedded
//! afterwards, whatever it was changed for; and since neighbours stay neighbours (`edits`) or meet
//! under the link condition (`collapse`), it stays closed and 2-manifold.
//!
//! All triangles that a change could meet must be in the patch: it holds every triangle whose box
//! meets its bounds, and no change reaches beyond them. Triangles are looked for by the leaf that
//! they belong to, so each of them also stays near that one ([`PatchTriangle::home`]).

mod bounds;
mod collapse;
mod edits;
mod index;
#[cfg(test)]
mod tests;
mod triangle;

use crate::contour::mesh::Changes;
pub use bounds::Bounds;
use index::{Boxes, Corners};
pub use triangle::{Homes, PatchEdge, PatchTriangle};

type Point = [f64; 3];

/// The vertices of a triangle that is gone: no vertex has this number.
const NOBODY: [u32; 3] = [u32::MAX; 3];

/// The number of triangles that most patches have room for. Twice as many are no harm.
const USUAL: usize = 1024;

/// A part of an embedded mesh.
#[derive(Debug)]
pub struct Patch {
    bounds: Bounds,
    homes: Homes,
    triangles: Vec<PatchTriangle>,
    /// The triangles by vertex, and by place.
    corners: Corners,
    boxes: Boxes,
    /// What was changed so far.
    pub changes: Changes,
}

impl Patch {
    /// A patch without triangles.
    pub fn new(bounds: Bounds, homes: Homes) -> Patch {
        Patch {
            bounds,
            homes,
            triangles: Vec::with_capacity(USUAL),
            corners: Corners::with_capacity(USUAL),
            boxes: Boxes::with_capacity(USUAL),
            changes: Changes::default(),
        }
    }

    /// Adds triangle `number` of the mesh, of the home with number `home`, if its box meets the
    /// bounds. All such triangles must be added before the first change.
    #[inline]
    pub fn add(&mut self, number: usize, vertices: &[u32; 3], corners: &[Point; 3], home: u8) {
        let around = Bounds::of_triangle(*corners);
        if around.meets(&self.bounds) {
            self.push(PatchTriangle { number, vertices: *vertices, corners: *corners, home }, around);
        }
    }

    /// Whether the mesh stays embedded when some triangles change and others are gone.
    fn accepts(&self, changed: &[(usize, PatchTriangle)], gone: &[usize]) -> bool {
        let Some(&(_, first)) = changed.first() else { return false };
        let boxes: Vec<Bounds> = changed.iter().map(|(_, t)| t.bounds()).collect();
        let around = boxes.iter().fold(first.bounds(), |all, b| all.with(b));
        if !self.bounds.contains(&around) || !changed.iter().all(|(_, t)| t.has_area()) {
            return false;
        }
        let is_at_home =
            |((_, t), b): (&(usize, PatchTriangle), &Bounds)| self.homes[usize::from(t.home)].contains(b);
        if !changed.iter().zip(&boxes).all(is_at_home) {
            return false;
        }
        for (i, (_, t)) in changed.iter().enumerate() {
            if changed[..i].iter().any(|(_, other)| t.meets(other)) {
                return false;
            }
        }
        for n in self.boxes.near(&around) {
            if changed.iter().any(|&(m, _)| m == n) || gone.contains(&n) {
                continue;
            }
            let (other, other_box) = (&self.triangles[n], self.boxes.of(n));
            let meets =
                |((_, t), b): (&(usize, PatchTriangle), &Bounds)| b.meets(other_box) && t.meets(other);
            if changed.iter().zip(&boxes).any(meets) {
                return false;
            }
        }
        true
    }

    fn put(&mut self, changed: &[(usize, PatchTriangle)]) {
        for &(n, triangle) in changed {
            if n < self.triangles.len() {
                self.corners.replace(n, self.triangles[n].vertices, triangle.vertices);
                self.triangles[n] = triangle;
                self.boxes.replace(n, triangle.bounds());
            } else {
                self.push(triangle, triangle.bounds());
            }
        }
    }

    /// Whether triangle `n` of the patch was taken out.
    pub fn is_gone(&self, n: usize) -> bool {
        self.triangles[n].vertices == NOBODY
    }

    /// Takes a triangle out; the numbers of the others stay.
    fn remove(&mut self, n: usize) {
        let nothing =
            PatchTriangle { number: usize::MAX, vertices: NOBODY, corners: [[f64::NAN; 3]; 3], home: 0 };
        self.corners.remove(n, self.triangles[n].vertices);
        self.triangles[n] = nothing;
        self.boxes.replace(n, Bounds::NOTHING);
    }

    #[inline]
    fn push(&mut self, triangle: PatchTriangle, bounds: Bounds) {
        self.triangles.push(triangle);
        self.corners.push(triangle.vertices);
        self.boxes.push(bounds);
    }

    /// The triangle with number `n` in the patch.
    pub fn triangle_at(&self, n: usize) -> &PatchTriangle {
        &self.triangles[n]
    }

    /// The numbers in the patch of the triangles with the given numbers of the mesh, which ascend.
    pub fn numbered(&self, numbers: &[usize]) -> Vec<usize> {
        let is_one = |n: &usize| numbers.binary_search(&self.triangles[*n].number).is_ok();
        (0..self.triangles.len()).filter(is_one).collect()
    }

    /// The numbers in the patch of the triangles at a vertex, ascending.
    pub fn star(&self, vertex: u32) -> Vec<usize> {
        let mut star: Vec<usize> = self.corners.of(vertex).map(|(n, _)| n).collect();
        star.sort_unstable();
        star
    }

    /// The position of a vertex of the patch.
    pub fn position(&self, vertex: u32) -> Option<Point> {
        self.corners.of(vertex).next().map(|(n, k)| self.triangles[n].corners[k])
    }

    /// Whether a vertex lies within `radius`, in model units, of `p`.
    pub fn is_taken(&self, p: Point, radius: f64) -> bool {
        let near = |q: Point| (0..3).map(|a| (q[a] - p[a]) * (q[a] - p[a])).sum::<f64>() <= radius * radius;
        let around = Bounds::around([p]).grown(radius);
        let mut triangles = self.boxes.near(&around).map(|n| &self.triangles[n]);
        triangles.any(|t| t.corners.into_iter().any(near))
    }

    /// The vertices within `radius` of `p`, by number, with the squares of their distances.
    pub fn vertices_near(&self, p: Point, radius: f64) -> Vec<(u32, f64)> {
        let distance2 = |q: Point| (0..3).map(|a| (q[a] - p[a]) * (q[a] - p[a])).sum::<f64>();
        let around = Bounds::around([p]).grown(radius);
        let near = self.boxes.near(&around).map(|n| &self.triangles[n]);
        let corners = near.flat_map(|t| t.vertices.into_iter().zip(t.corners));
        let mut all: Vec<(u32, f64)> =
            corners.map(|(v, q)| (v, distance2(q))).filter(|(_, d)| *d <= radius * radius).collect();
        all.sort_unstable_by_key(|(v, _)| *v);
        all.dedup_by_key(|(v, _)| *v);
        all
    }

    /// The edges at a vertex and those opposite to it, with both their triangles.
    pub fn edges_around(&self, vertex: u32) -> Vec<PatchEdge> {
        let star = self.star(vertex);
        let mut edges = Vec::with_capacity(2 * star.len());
        for n in star {
            let Some(k) = self.triangles[n].place(vertex) else { continue };
            // The edge from the vertex on, and the opposite one: each edge once.
            for side in [k, (k + 1) % 3] {
                edges.extend(self.edge(n, side));
            }
        }
        edges
    }

    /// Whether two vertices have an edge.
    fn are_neighbours(&self, a: u32, b: u32) -> bool {
        self.corners.of(a).any(|(n, _)| self.triangles[n].vertices.contains(&b))
    }

    /// Side `side` of triangle `n`, with the triangle beyond it.
    pub fn edge(&self, n: usize, side: usize) -> Option<PatchEdge> {
        let t = &self.triangles[n];
        let corner = |k: usize| (t.vertices[k % 3], t.corners[k % 3]);
        let (a, b, c) = (corner(side), corner(side + 1), corner(side + 2));
        let is_beyond = |&(m, k): &(usize, usize)| self.triangles[m].vertices[(k + 1) % 3] == a.0;
        let (m, k) = self.corners.of(b.0).find(is_beyond)?;
        let other = &self.triangles[m];
        let d = (other.vertices[(k + 2) % 3], other.corners[(k + 2) % 3]);
        Some(PatchEdge { triangles: [n, m], a, b, c, d })
    }
}
