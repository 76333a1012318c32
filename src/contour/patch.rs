//! A part of a finished mesh that can be changed without making it intersect itself.
//!
//! The mesh is embedded: triangles meet in the vertices and edges that they share, and nowhere else. A vertex is
//! moved, or an edge flipped, only if the triangles that this changes meet no other triangle and not each other,
//! decided by exact predicates on the coordinates as they will be written. Then the mesh is embedded afterwards,
//! whatever it was changed for; and since the triangles keep their neighbours, it stays closed and 2-manifold.
//!
//! All triangles that a change could meet must be in the patch: it holds every triangle whose box meets its
//! bounds, and no change reaches beyond them. Triangles are looked for by the leaf that they belong to, so each of
//! them also stays near that one ([`PatchTriangle::home`]).

use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;

type Point = [f64; 3];

/// A closed box.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// The lowest coordinates.
    pub lo: Point,
    /// The highest coordinates.
    pub hi: Point,
}

impl Bounds {
    /// The box around points; nothing around none.
    pub fn around(points: impl IntoIterator<Item = Point>) -> Bounds {
        let nothing = Bounds { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };
        points.into_iter().fold(nothing, |all, p| all.with(&Bounds { lo: p, hi: p }))
    }

    /// The box with `margin` around it.
    pub fn grown(&self, margin: f64) -> Bounds {
        Bounds { lo: self.lo.map(|x| x - margin), hi: self.hi.map(|x| x + margin) }
    }

    /// What two boxes have in common.
    pub fn within(&self, other: &Bounds) -> Bounds {
        Bounds {
            lo: std::array::from_fn(|a| self.lo[a].max(other.lo[a])),
            hi: std::array::from_fn(|a| self.hi[a].min(other.hi[a])),
        }
    }

    /// Whether two boxes have a point in common.
    #[inline(always)]
    pub fn meets(&self, other: &Bounds) -> bool {
        // No short cuts: six comparisons side by side are faster than branches.
        (self.lo[0] <= other.hi[0])
            & (other.lo[0] <= self.hi[0])
            & (self.lo[1] <= other.hi[1])
            & (other.lo[1] <= self.hi[1])
            & (self.lo[2] <= other.hi[2])
            & (other.lo[2] <= self.hi[2])
    }

    /// Whether `other` lies in this box.
    pub fn contains(&self, other: &Bounds) -> bool {
        (0..3).all(|a| self.lo[a] <= other.lo[a] && other.hi[a] <= self.hi[a])
    }

    fn with(&self, other: &Bounds) -> Bounds {
        Bounds {
            lo: std::array::from_fn(|a| self.lo[a].min(other.lo[a])),
            hi: std::array::from_fn(|a| self.hi[a].max(other.hi[a])),
        }
    }
}

/// A triangle of a patch.
#[derive(Clone, Copy, Debug)]
pub struct PatchTriangle {
    /// Its number in the mesh.
    pub number: usize,
    /// The numbers of its vertices in the mesh.
    pub vertices: [u32; 3],
    /// Their positions.
    pub corners: [Point; 3],
    /// Which of the patch's homes it belongs to and may not leave.
    pub home: u8,
}

/// The home of the triangles that a patch adds: its own leaf.
pub const OWN_HOME: u8 = 13;

/// The homes of a patch: around the leaf and each of its 26 neighbours, z fastest.
pub type Homes = [Bounds; 27];

impl PatchTriangle {
    fn bounds(&self) -> Bounds {
        Bounds::around(self.corners)
    }

    fn has_area(&self) -> bool {
        projection_axis(self.corners).is_some()
    }

    fn meets(&self, other: &PatchTriangle) -> bool {
        meeting_point(self.vertices, self.corners, other.vertices, other.corners).is_some()
    }

    /// The place of a vertex in the triangle.
    fn place(&self, vertex: u32) -> Option<usize> {
        self.vertices.iter().position(|&v| v == vertex)
    }

    fn position(&self, vertex: u32) -> Option<Point> {
        self.place(vertex).map(|k| self.corners[k])
    }
}

/// What a patch changed, by numbers of the mesh. Vertices and triangles that it added are numbered on from
/// [`NEW_VERTEX`] and [`NEW_TRIANGLE`].
#[derive(Debug, Default)]
pub struct Changes {
    /// New positions of vertices; the last one counts.
    pub moved: Vec<(u32, Point)>,
    /// New vertices of triangles; the last ones count.
    pub triangles: Vec<(usize, [u32; 3])>,
    /// Vertices added.
    pub new_vertices: u32,
    /// Triangles added.
    pub new_triangles: usize,
}

/// The number of the first vertex that a patch adds.
pub const NEW_VERTEX: u32 = 1 << 31;

/// The number of the first triangle that a patch adds.
pub const NEW_TRIANGLE: usize = 1 << 40;

/// The edge between two triangles, seen from the first: it runs from `a` to `b` there.
#[derive(Clone, Copy, Debug)]
pub struct PatchEdge {
    triangles: [usize; 2],
    /// The ends of the edge and the vertices opposite to it in the first and in the second triangle.
    pub a: (u32, Point),
    /// See `a`.
    pub b: (u32, Point),
    /// See `a`.
    pub c: (u32, Point),
    /// See `a`.
    pub d: (u32, Point),
}

/// A part of an embedded mesh.
#[derive(Debug)]
pub struct Patch {
    bounds: Bounds,
    homes: Homes,
    triangles: Vec<PatchTriangle>,
    /// Their vertices and boxes, which are searched all the time.
    vertices: Vec<[u32; 3]>,
    boxes: Vec<Bounds>,
    /// What was changed so far.
    pub changes: Changes,
}

impl Patch {
    /// The triangles among `triangles` whose boxes meet `bounds`.
    pub fn new(bounds: Bounds, homes: Homes, triangles: impl Iterator<Item = PatchTriangle>) -> Patch {
        let mut patch = Patch {
            bounds,
            homes,
            triangles: Vec::new(),
            vertices: Vec::new(),
            boxes: Vec::new(),
            changes: Changes::default(),
        };
        for triangle in triangles {
            let around = triangle.bounds();
            if around.meets(&bounds) {
                patch.push(triangle, around);
            }
        }
        patch
    }

    /// Moves a vertex to `to`, which must be rounded, if the mesh stays embedded.
    pub fn try_move(&mut self, vertex: u32, to: Point) -> bool {
        let moved = |n: usize| {
            let mut triangle = self.triangles[n];
            if let Some(k) = triangle.place(vertex) {
                triangle.corners[k] = to;
            }
            (n, triangle)
        };
        let star: Vec<(usize, PatchTriangle)> = self.star(vertex).into_iter().map(moved).collect();
        if !self.accepts(&star) {
            return false;
        }
        self.put(&star);
        self.changes.moved.push((vertex, to));
        true
    }

    /// Puts a new vertex at `at`, which must be rounded, in place of a triangle's interior, if the mesh stays
    /// embedded. Returns its number.
    pub fn try_split_face(&mut self, n: usize, at: Point) -> Option<u32> {
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

    /// Puts a new vertex at `at`, which must be rounded, in place of an edge's interior, if the mesh stays
    /// embedded. Returns its number.
    pub fn try_split_edge(&mut self, edge: &PatchEdge, at: Point) -> Option<u32> {
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

    fn new_vertex(&self) -> Option<u32> {
        NEW_VERTEX.checked_add(self.changes.new_vertices)
    }

    fn new_triangle(&self, n: usize) -> usize {
        NEW_TRIANGLE + self.changes.new_triangles + n
    }

    /// A triangle of the patch's own leaf.
    fn triangle(&self, number: usize, corners: [(u32, Point); 3]) -> PatchTriangle {
        PatchTriangle {
            number,
            vertices: corners.map(|c| c.0),
            corners: corners.map(|c| c.1),
            home: OWN_HOME,
        }
    }

    /// Triangle `n` of the patch with other corners.
    fn reshaped(&self, n: usize, corners: [(u32, Point); 3]) -> PatchTriangle {
        let PatchTriangle { number, home, .. } = self.triangles[n];
        PatchTriangle { home, ..self.triangle(number, corners) }
    }

    /// Accepts a split into `parts`, of which two are new.
    fn insert(&mut self, parts: &[(usize, PatchTriangle)], vertex: u32, at: Point) -> Option<u32> {
        if !self.accepts(parts) {
            return None;
        }
        self.put(parts);
        self.changes.new_vertices += 1;
        self.changes.new_triangles += 2;
        self.changes.moved.push((vertex, at));
        self.changes.triangles.extend(parts.iter().map(|(_, t)| (t.number, t.vertices)));
        Some(vertex)
    }

    /// Replaces an edge by the other diagonal of its two triangles, if the mesh stays embedded.
    pub fn try_flip(&mut self, edge: &PatchEdge) -> bool {
        let PatchEdge { triangles: [first, second], a, b, c, d } = *edge;
        let joined = |v: &[u32; 3]| v.contains(&c.0) && v.contains(&d.0);
        if self.vertices.iter().any(joined) {
            return false;
        }
        let pair = [(first, self.reshaped(first, [a, d, c])), (second, self.reshaped(second, [d, b, c]))];
        if !self.accepts(&pair) {
            return false;
        }
        self.put(&pair);
        self.changes.triangles.extend(pair.map(|(_, t)| (t.number, t.vertices)));
        true
    }

    /// Whether the mesh stays embedded when the given triangles change.
    fn accepts(&self, changed: &[(usize, PatchTriangle)]) -> bool {
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
        for (n, (other, other_box)) in self.triangles.iter().zip(&self.boxes).enumerate() {
            if !other_box.meets(&around) || changed.iter().any(|&(m, _)| m == n) {
                continue;
            }
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
                self.triangles[n] = triangle;
                self.vertices[n] = triangle.vertices;
                self.boxes[n] = triangle.bounds();
            } else {
                self.push(triangle, triangle.bounds());
            }
        }
    }

    fn push(&mut self, triangle: PatchTriangle, bounds: Bounds) {
        self.triangles.push(triangle);
        self.vertices.push(triangle.vertices);
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

    /// The numbers in the patch of the triangles at a vertex.
    pub fn star(&self, vertex: u32) -> Vec<usize> {
        // Compared without short cuts, for speed.
        let has = |[a, b, c]: [u32; 3]| (a == vertex) | (b == vertex) | (c == vertex);
        self.vertices.iter().enumerate().filter_map(|(n, &v)| has(v).then_some(n)).collect()
    }

    /// The position of a vertex of the patch.
    pub fn position(&self, vertex: u32) -> Option<Point> {
        self.triangles.iter().find_map(|t| t.position(vertex))
    }

    /// Whether a vertex other than `vertex` lies within `radius` of `p`.
    pub fn is_taken(&self, p: Point, radius: f64, vertex: u32) -> bool {
        let near = |q: Point| (0..3).map(|a| (q[a] - p[a]) * (q[a] - p[a])).sum::<f64>() <= radius * radius;
        self.triangles.iter().any(|t| t.vertices.iter().zip(t.corners).any(|(&v, q)| v != vertex && near(q)))
    }

    /// The edges at a vertex and those opposite to it, with both their triangles.
    pub fn edges_around(&self, vertex: u32) -> Vec<PatchEdge> {
        let star = self.star(vertex);
        let Some(&first) = star.first() else { return Vec::new() };
        let around = star.iter().fold(self.boxes[first], |all, &n| all.with(&self.boxes[n]));
        let near = self.near(&around);
        let mut edges = Vec::with_capacity(2 * star.len());
        for &n in &star {
            let Some(k) = self.triangles[n].place(vertex) else { continue };
            // The edge from the vertex on, and the opposite one: each edge once.
            for side in [k, (k + 1) % 3] {
                edges.extend(self.edge_among(&near, n, side));
            }
        }
        edges
    }

    /// Side `side` of triangle `n`, with the triangle beyond it.
    pub fn edge(&self, n: usize, side: usize) -> Option<PatchEdge> {
        self.edge_among(&self.near(&self.boxes[n]), n, side)
    }

    /// The numbers in the patch of the triangles whose boxes meet `bounds`.
    fn near(&self, bounds: &Bounds) -> Vec<usize> {
        let meets = |(n, b): (usize, &Bounds)| b.meets(bounds).then_some(n);
        self.boxes.iter().enumerate().filter_map(meets).collect()
    }

    /// Side `side` of triangle `n`, with the triangle beyond it, which is one of `near`.
    fn edge_among(&self, near: &[usize], n: usize, side: usize) -> Option<PatchEdge> {
        let t = &self.triangles[n];
        let corner = |k: usize| (t.vertices[k % 3], t.corners[k % 3]);
        let (a, b, c) = (corner(side), corner(side + 1), corner(side + 2));
        let (m, k) = near.iter().find_map(|&m| {
            let [p, q, r] = self.vertices[m];
            let k = [(p, q), (q, r), (r, p)].into_iter().position(|edge| edge == (b.0, a.0))?;
            Some((m, k))
        })?;
        let other = &self.triangles[m];
        let d = (other.vertices[(k + 2) % 3], other.corners[(k + 2) % 3]);
        Some(PatchEdge { triangles: [n, m], a, b, c, d })
    }
}
