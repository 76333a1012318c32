//! Assembles a mesh from patches that share their boundary vertices.
//!
//! A patch never makes the vertices of its boundary: it is handed their numbers. Neighbouring
//! patches are handed the same numbers, so the result is closed by construction and nothing has to
//! be welded.

use crate::mesh::TriMesh;
use spade::{AngleLimit, ConstrainedDelaunayTriangulation, Point2, RefinementParameters, Triangulation};
use std::collections::{BTreeMap, BTreeSet};

/// A point in model units.
pub(super) type Point = [f64; 3];

/// A mesh in the making.
#[derive(Debug)]
pub(super) struct Builder {
    mesh: TriMesh,
    /// Wished length of the triangles' sides, in model units.
    side: f64,
    /// Interior vertices of the curves between corners, by (smaller, larger) corner, from the
    /// smaller on.
    curves: BTreeMap<(u32, u32), Vec<u32>>,
}

impl Builder {
    /// Returns a builder of triangles with about `detail` sides per unit of length.
    pub fn new(detail: u32) -> Self {
        // Below two the holes and arcs of the models degenerate to segments.
        let side = 1.0 / f64::from(detail.max(2));
        Builder { mesh: TriMesh::default(), side, curves: BTreeMap::new() }
    }

    /// Returns the finished mesh.
    pub fn finish(self) -> TriMesh {
        self.mesh
    }

    /// Returns the number of sides that a curve of `length` is divided into, at least `least`.
    pub fn divisions(&self, length: f64, least: usize) -> usize {
        ((length / self.side).round() as usize).max(least)
    }

    /// Adds a vertex.
    pub fn vertex(&mut self, p: Point) -> u32 {
        self.mesh.vertices.push(p);
        (self.mesh.vertices.len() - 1) as u32
    }

    /// Adds vertices.
    pub fn vertices(&mut self, points: impl IntoIterator<Item = Point>) -> Vec<u32> {
        points.into_iter().map(|p| self.vertex(p)).collect()
    }

    /// Returns the position of a vertex.
    pub fn position(&self, v: u32) -> Point {
        self.mesh.vertices[v as usize]
    }

    /// Adds a triangle, counter-clockwise seen from outside.
    pub fn triangle(&mut self, a: u32, b: u32, c: u32) {
        self.mesh.triangles.push([a, b, c]);
    }

    /// Makes the curve between corners `a` and `b` run through `points` (from `a` to `b`, both
    /// exclusive). Curves that are not made so are straight.
    pub fn curve(&mut self, a: u32, b: u32, points: impl IntoIterator<Item = Point>) {
        let mut inner = self.vertices(points);
        if a > b {
            inner.reverse();
        }
        self.curves.insert((a.min(b), a.max(b)), inner);
    }

    /// Returns all vertices of the curve from corner `a` to corner `b`, both inclusive. The first
    /// call for a pair of corners makes a straight curve unless [`curve`](Self::curve) made another
    /// before.
    pub fn walk(&mut self, a: u32, b: u32) -> Vec<u32> {
        let key = (a.min(b), a.max(b));
        if !self.curves.contains_key(&key) {
            let (p, q) = (self.position(key.0), self.position(key.1));
            let n = self.divisions(distance(p, q), 1);
            let inner = self.vertices((1..n).map(|i| mix(p, q, i as f64 / n as f64)));
            self.curves.insert(key, inner);
        }
        let mut all = vec![key.0];
        all.extend(&self.curves[&key]);
        all.push(key.1);
        if a > b {
            all.reverse();
        }
        all
    }

    /// Returns the closed loop through `corners`, each vertex once.
    pub fn outline(&mut self, corners: &[u32]) -> Vec<u32> {
        let mut all = Vec::new();
        for (i, &a) in corners.iter().enumerate() {
            let mut part = self.walk(a, corners[(i + 1) % corners.len()]);
            part.pop();
            all.extend(part);
        }
        all
    }

    /// Returns a closed loop of vertices around `centre`: at `radius` in the plane of the axes `u`
    /// and `v`, running from `u` to `v`.
    pub fn circle(&mut self, centre: Point, u: usize, v: usize, radius: f64) -> Vec<u32> {
        let n = self.divisions(std::f64::consts::TAU * radius, 12).div_ceil(4) * 4;
        self.circle_of(n, centre, u, v, radius)
    }

    /// Returns a [`circle`](Self::circle) of exactly `n` vertices.
    pub fn circle_of(&mut self, n: usize, centre: Point, u: usize, v: usize, radius: f64) -> Vec<u32> {
        self.vertices((0..n).map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
            let mut p = centre;
            p[u] += radius * cos;
            p[v] += radius * sin;
            p
        }))
    }

    /// Returns the loop `around`, moved by `by`.
    pub fn moved(&mut self, around: &[u32], by: Point) -> Vec<u32> {
        let points: Vec<Point> = around.iter().map(|&v| add(self.position(v), by)).collect();
        self.vertices(points)
    }

    /// A strip of quads between two open rows of equal length; `low` runs to the right of someone
    /// who stands outside with `high` above.
    pub fn strip(&mut self, low: &[u32], high: &[u32]) {
        assert_eq!(low.len(), high.len(), "the rows of a strip have equal length");
        for (l, h) in low.windows(2).zip(high.windows(2)) {
            self.triangle(l[0], l[1], h[1]);
            self.triangle(l[0], h[1], h[0]);
        }
    }

    /// The straight wall between two closed loops of equal length, oriented as in
    /// [`strip`](Self::strip).
    pub fn wall(&mut self, low: &[u32], high: &[u32]) {
        let height = distance(self.position(low[0]), self.position(high[0]));
        let rows = self.divisions(height, 1);
        let mut below = closed(low);
        for j in 1..=rows {
            let row = if j == rows {
                closed(high)
            } else {
                let t = j as f64 / rows as f64;
                let points: Vec<Point> =
                    low.iter().zip(high).map(|(&a, &b)| mix(self.position(a), self.position(b), t)).collect();
                closed(&self.vertices(points))
            };
            self.strip(&below, &row);
            below = row;
        }
    }

    /// The wall that straight lines between the open rows `low` and `high` rule, with the given
    /// `left` and `right` ends (each from low to high, both inclusive).
    pub fn ruled(&mut self, low: &[u32], high: &[u32], left: &[u32], right: &[u32]) {
        assert_eq!(left.len(), right.len(), "both ends of a ruled patch have equal length");
        let rows = left.len() - 1;
        let mut below = low.to_vec();
        for j in 1..=rows {
            let row = if j == rows {
                high.to_vec()
            } else {
                let t = j as f64 / rows as f64;
                let mut row = vec![left[j]];
                for i in 1..low.len() - 1 {
                    row.push(self.vertex(mix(self.position(low[i]), self.position(high[i]), t)));
                }
                row.push(right[j]);
                row
            };
            self.strip(&below, &row);
            below = row;
        }
    }

    /// The flat face with the boundary `loops`: the first is the outer one, counter-clockwise seen
    /// from outside, the others are holes in the other direction.
    pub fn flat(&mut self, loops: &[&[u32]]) {
        let normal = self.newell(loops[0]);
        let drop = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(2);
        let base = self.position(loops[0][0]);
        let level = loops[0].iter().all(|&v| self.position(v)[drop] == base[drop]);
        self.lifted(loops, drop, |mut p| {
            let slope: f64 = (0..3).filter(|&a| a != drop).map(|a| normal[a] * (p[a] - base[a])).sum();
            // A face at a constant coordinate stays at exactly that coordinate.
            p[drop] = if level { base[drop] } else { base[drop] - slope / normal[drop] };
            p
        });
    }

    /// Returns a patch that is a graph over the plane across axis `drop`: triangulated in that
    /// plane, and each new vertex moved onto the surface by `lift`, which must change the
    /// coordinate `drop` only. As a graph it cannot intersect itself.
    pub fn lifted(&mut self, loops: &[&[u32]], drop: usize, lift: impl Fn(Point) -> Point) {
        let (u, v) = ((drop + 1) % 3, (drop + 2) % 3);
        let mut ids: Vec<u32> = loops.iter().flat_map(|l| l.iter().copied()).collect();
        let flat: Vec<Point2<f64>> =
            ids.iter().map(|&i| Point2::new(self.position(i)[u], self.position(i)[v])).collect();
        let (points, triangles) = triangulate(flat, loops, self.side);
        let turned = self.newell(loops[0])[drop] < 0.0;
        for q in &points[ids.len()..] {
            let mut p = [0.0; 3];
            p[u] = q.x;
            p[v] = q.y;
            ids.push(self.vertex(lift(p)));
        }
        for [a, b, c] in triangles.into_iter().map(|t| t.map(|i| ids[i])) {
            if turned { self.triangle(a, c, b) } else { self.triangle(a, b, c) }
        }
    }

    /// Returns the normal of a closed loop, of the length of twice its area.
    fn newell(&self, around: &[u32]) -> Point {
        let mut n = [0.0; 3];
        for (i, &v) in around.iter().enumerate() {
            let (p, q) = (self.position(v), self.position(around[(i + 1) % around.len()]));
            for (a, n) in n.iter_mut().enumerate() {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                *n += (p[b] - q[b]) * (p[c] + q[c]);
            }
        }
        n
    }
}

/// Triangulates the region between loops of `points`, with new points behind the given ones, which
/// stay as they are; triangles are counter-clockwise.
fn triangulate(points: Vec<Point2<f64>>, loops: &[&[u32]], side: f64) -> (Vec<Point2<f64>>, Vec<[usize; 3]>) {
    let mut edges = Vec::with_capacity(points.len());
    let mut start = 0;
    for l in loops {
        edges.extend((0..l.len()).map(|i| [start + i, start + (i + 1) % l.len()]));
        start += l.len();
    }
    let given = points.len();
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::bulk_load_cdt(points, edges)
        .expect("the models' coordinates are finite");
    assert_eq!(cdt.num_vertices(), given, "the models' boundaries have no double points");
    let area: f64 = side * side;
    let settings = RefinementParameters::new()
        .exclude_outer_faces(true)
        // The neighbouring patches have the same boundary, so it must not be divided further.
        .keep_constraint_edges()
        // Half the square on the wished side is the area of its two triangles.
        .with_max_allowed_area(0.5 * area)
        .with_min_required_area(0.05 * area)
        .with_angle_limit(AngleLimit::from_deg(25.0))
        .with_max_additional_vertices(4_000_000);
    let outside: BTreeSet<_> = cdt.refine(settings).excluded_faces.iter().map(|f| f.index()).collect();
    let triangles = cdt
        .inner_faces()
        .filter(|f| !outside.contains(&f.fix().index()))
        .map(|f| f.vertices().map(|v| v.index()))
        .collect();
    (cdt.vertices().map(|v| v.position()).collect(), triangles)
}

fn closed(around: &[u32]) -> Vec<u32> {
    around.iter().chain(&around[..1]).copied().collect()
}

/// Returns a loop in the other direction.
pub(super) fn reversed(around: &[u32]) -> Vec<u32> {
    around.iter().rev().copied().collect()
}

/// Returns the sum of two vectors.
pub(super) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Returns the point at fraction `t` of the way from `a` to `b`.
pub(super) fn mix(a: Point, b: Point, t: f64) -> Point {
    std::array::from_fn(|i| if a[i] == b[i] { a[i] } else { a[i] + t * (b[i] - a[i]) })
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}
