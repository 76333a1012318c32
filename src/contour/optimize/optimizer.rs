//! Changes of a finished mesh that bring it nearer to the surface: which to try. Whether they are made decides the
//! exact test of `patch`.

use super::distance_cache::Answers;
use super::patch::{Patch, PatchEdge, PatchTriangle};
use crate::contour::feature::{Asker, Features, Sides, VertexSet, feature_between, nearest};
use crate::contour::implicit_surface::Surface;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::contour::vertex::Cells;
use crate::geom::quadric::{cross, dot};

type Point = [f64; 3];

/// Edges whose triangles' normals differ by less than this (cosine of 5 degrees) are not worth flipping.
const FLAT: f64 = 0.996;

/// Edges whose middle is nearer to the surface than this, in voxels, stay.
const GOOD_EDGE: f64 = 0.01;

/// Points that are nearer than this, in voxels, to the sides that features nearby know are not asked about.
const SURE: f64 = 0.01;

/// A flip must bring the middle of the edge nearer by this factor.
const GAIN: f64 = 0.5;

/// A place is taken when a vertex is as near as this, in voxels.
const TAKEN: f64 = 0.01;

/// Shares of the way to its place that the vertex of a split goes: another triangle can be in its way.
const SHARES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// A part of the way must bring the vertex of a split nearer by this factor.
const GOOD_PART: f64 = 0.8;

/// The most splits that come of one vertex. Where the surface jumps, splits do not bring it nearer, and would go on
/// without end.
const MOST_SPLITS: u64 = 12;

/// A patch with the surface that it shall come near to.
pub struct Editor<'a> {
    /// The part of the mesh.
    pub patch: Patch,
    /// The surface.
    pub surface: &'a dyn Surface,
    /// The lattice, for its precision.
    pub lattice: &'a RoundedLattice,
    /// The vertices on creases and corners.
    pub features: &'a Features,
    /// The vertices where the sign jumps.
    pub jumps: &'a VertexSet,
    /// Triangles, edges and vertices that are farther from the surface, in voxels, are split and moved.
    pub tolerance: f64,
    /// Whether what the features nearby say is enough where they say that the surface is near.
    pub trusting: bool,
    /// See [`Surface::at`].
    pub piece: u32,
    /// How far points are from the surface, in voxels.
    pub answers: Answers,
    /// Splits that may still be made.
    pub splits_left: u64,
    /// Vertices whose splits ended at a limit.
    pub given_up: u64,
}

impl<'a> Editor<'a> {
    /// An editor of a patch of the mesh of `cells`. See the fields.
    pub fn new(
        patch: Patch,
        surface: &'a dyn Surface,
        cells: &'a Cells<'_>,
        tolerance: f64,
        trusting: bool,
    ) -> Editor<'a> {
        let (lattice, features, jumps) = (&cells.context.lattice, &cells.features, &cells.jumps);
        let (piece, answers, splits_left, given_up) = (0, Answers::new(), u64::MAX, 0);
        Editor {
            patch,
            surface,
            lattice,
            features,
            jumps,
            tolerance,
            trusting,
            piece,
            answers,
            splits_left,
            given_up,
        }
    }
}

impl Editor<'_> {
    /// Where a vertex that is far from the surface would be on it.
    pub fn place_on_surface(&mut self, vertex: u32) -> Option<Point> {
        let origin = self.patch.position(vertex)?;
        let mut ask = Asker { surface: self.surface, origin, voxel: self.voxel(), piece: self.piece };
        let is_far = ask.at([0.0; 3]).0.abs() > self.tolerance;
        let place = if is_far { nearest(&mut ask, [0.0; 3]) } else { None };
        self.piece = ask.piece;
        place.map(|p| self.lattice.round(std::array::from_fn(|i| origin[i] + self.voxel() * p[i])))
    }

    /// Flips edges at and around a vertex that cut through the solid or the air beside a crease.
    pub fn flip_around(&mut self, vertex: u32) -> u64 {
        let mut flipped = 0;
        // Every flip brings the surface nearer; the limit is for rounding.
        while flipped < 8 {
            let edges = self.patch.edges_around(vertex);
            let Some(()) = edges.iter().find_map(|edge| self.flip(edge)) else { break };
            flipped += 1;
        }
        flipped
    }

    fn flip(&mut self, edge: &PatchEdge) -> Option<()> {
        let PatchEdge { a, b, c, d, .. } = *edge;
        if is_flat(edge) {
            return None;
        }
        let sides = self.features.sides([a, b, c, d].map(|v| v.0).into_iter());
        let now = self.error(middle(a.1, b.1), &sides);
        if now < GOOD_EDGE {
            return None;
        }
        let then = self.error(middle(c.1, d.1), &Sides::NONE);
        (then < GAIN * now && self.patch.try_flip(edge)).then_some(())
    }

    /// Splits the triangles at a vertex, and their edges, where they are far from the surface, and what came of that
    /// again.
    pub fn split_around(&mut self, vertex: u32) -> u64 {
        let mut split = 0;
        let mut vertices = vec![vertex];
        let mut next = 0;
        while let Some(&vertex) = vertices.get(next) {
            next += 1;
            let mut open = self.patch.star(vertex);
            while let Some(n) = open.pop() {
                let Some(worst) = self.worst(n) else { continue };
                if split == MOST_SPLITS || self.splits_left == 0 {
                    self.given_up += 1;
                    return split;
                }
                let Some(new) = self.improve(n, worst) else { continue };
                split += 1;
                self.splits_left -= 1;
                vertices.push(new);
                self.flip_around(new);
                open.retain(|&n| self.patch.triangle_at(n).vertices.contains(&vertex));
            }
        }
        split
    }

    /// Whether a triangle at a vertex is far from the surface.
    pub fn is_far_around(&mut self, vertex: u32) -> bool {
        self.patch.star(vertex).into_iter().any(|n| self.worst(n).is_some())
    }

    /// Where a triangle is farthest from the surface, if that is beyond the tolerance and not where the sign jumps: the number
    /// of a side or 3 for its centre, and the place.
    pub fn worst(&mut self, n: usize) -> Option<(usize, Point)> {
        if self.jumps.contains_any(self.patch.triangle_at(n).vertices) {
            return None;
        }
        let (worst, place, error) = self.farthest(n)?;
        (error > self.tolerance).then_some((worst, place))
    }

    /// Whether a triangle is farther from the surface than the tolerance.
    pub fn is_beyond(&mut self, n: usize) -> bool {
        self.farthest(n).is_some_and(|(_, _, error)| error > self.tolerance)
    }

    /// Where a triangle is farthest from the surface, and how far.
    fn farthest(&mut self, n: usize) -> Option<(usize, Point, f64)> {
        let t = *self.patch.triangle_at(n);
        let [a, b, c] = t.corners;
        let centre = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
        let places = [middle(a, b), middle(b, c), middle(c, a), centre];
        let sides = self.sides(&t);
        let errors = places.map(|p| self.error(p, &sides));
        let worst = (0..4).max_by(|&i, &j| errors[i].total_cmp(&errors[j]))?;
        Some((worst, places[worst], errors[worst]))
    }

    /// Splits a triangle, or an edge of it, where it is farthest from the surface as [`worst`](Self::worst) says, or merges the
    /// ends of an edge if that is not possible. Returns the vertex around which the triangles are others now.
    pub fn improve(&mut self, n: usize, (worst, from): (usize, Point)) -> Option<u32> {
        self.split(n, worst, from).or_else(|| self.mend(n))
    }

    fn split(&mut self, n: usize, worst: usize, from: Point) -> Option<u32> {
        let [a, b, c] = self.patch.triangle_at(n).corners;
        let edge = if worst < 3 { self.patch.edge(n, worst) } else { None };
        let around: Vec<Point> = match &edge {
            Some(edge) => vec![edge.a.1, edge.b.1, edge.c.1, edge.d.1],
            None => vec![a, b, c],
        };
        let targets = self.surface_points(from, &around);
        for (share, target) in SHARES.into_iter().flat_map(|share| targets.map(|target| (share, target))) {
            let Some(target) = target else { continue };
            let target = self.lattice.round(mix(from, target, share));
            // Part of the way to a crease can lead away from the surface.
            if share < 1.0 && self.error(target, &Sides::NONE) > GOOD_PART * self.error(from, &Sides::NONE) {
                continue;
            }
            if self.patch.is_taken(target, TAKEN * self.voxel(), u32::MAX) {
                continue;
            }
            let new = match &edge {
                Some(edge) => self.patch.try_split_edge(edge, target),
                None => self.patch.try_split_face(n, target),
            };
            if new.is_some() {
                return new;
            }
        }
        None
    }

    /// Points of the surface near `from`: the crease or corner between the sides that are seen from there towards
    /// the points around, and the next point at all.
    fn surface_points(&mut self, from: Point, around: &[Point]) -> [Option<Point>; 2] {
        let mut ask = Asker { surface: self.surface, origin: from, voxel: self.voxel(), piece: self.piece };
        let towards = around.iter().map(|p| std::array::from_fn(|i| 0.5 * (p[i] - from[i]) / self.voxel()));
        let crease = feature_between(&mut ask, towards);
        let next = nearest(&mut ask, [0.0; 3]);
        self.piece = ask.piece;
        let world = |p: Point| std::array::from_fn(|i| from[i] + self.voxel() * p[i]);
        [crease.map(world), next.map(world)]
    }

    /// What the features at the corners of a triangle know of the surface, if that is enough.
    pub fn sides(&self, t: &PatchTriangle) -> Sides {
        if self.trusting { self.features.sides(t.vertices.into_iter()) } else { Sides::NONE }
    }

    fn voxel(&self) -> f64 {
        self.lattice.voxel()
    }

    /// The distance of a point from the surface, in voxels, if that can be more than [`SURE`] by what the sides of
    /// features near it say; else 0.
    pub fn error(&mut self, p: Point, sides: &Sides) -> f64 {
        if !sides.is_empty() && sides.distance(p) < SURE * self.voxel() {
            return 0.0;
        }
        let voxel = self.voxel();
        self.answers.get(p, || self.surface.at(p, &mut self.piece).0.abs() / voxel)
    }
}

/// The point at `share` of the way from `a` to `b`.
pub fn mix(a: Point, b: Point, share: f64) -> Point {
    std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
}

/// The middle of a segment.
pub fn middle(p: Point, q: Point) -> Point {
    std::array::from_fn(|i| 0.5 * (p[i] + q[i]))
}

fn is_flat(edge: &PatchEdge) -> bool {
    let PatchEdge { a, b, c, d, .. } = edge;
    let minus = |p: Point, q: Point| -> Point { std::array::from_fn(|i| p[i] - q[i]) };
    let along = minus(b.1, a.1);
    let (n, m) = (cross(along, minus(c.1, a.1)), cross(minus(d.1, a.1), along));
    dot(n, m) > FLAT * (dot(n, n) * dot(m, m)).sqrt()
}
