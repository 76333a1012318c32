//! Edges merged to a vertex where another change is in the way.

use super::optimizer::{Editor, middle};
use super::patch::PatchTriangle;
use crate::contour::feature::{FeatureVertex, Sides};
use crate::geom::quadric::{along, cross, distance2, dot};
use crate::geom::triangle::Triangle;
use glam::DVec3;

type Point = [f64; 3];

/// Corners nearer to each other than this, in voxels, are one: two cells have found it, each with a rounding of its own.
const SAME_CORNER: f64 = 1e-3;

/// Triangles with a height below this, in voxels, are thin.
const THIN: f64 = 0.05;

/// Triangles that are nearer to the surface than this, in voxels, may become as far from it.
const SMOOTH: f64 = 0.01;

/// Vertices within this distance of a corner, in voxels, can stand in for the one that cannot go there.
const NEAR: f64 = 1.0;

/// The most vertices that are tried.
const MOST_OTHERS: usize = 6;

/// A merge that is to bring triangles nearer to the surface must do so by this factor.
const MENDED: f64 = 0.5;

/// The most merges around one vertex; each takes two triangles away.
const MOST_MERGES: u64 = 8;

/// A vertex that goes may leave this much of the surface without a triangle near it, in voxels: else corners that
/// nobody remembers are cut off.
const LOST: f64 = 2e-3;

/// How a vertex came to its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Alone.
    Moved,
    /// A neighbour was merged into it.
    Merged,
}

impl Editor<'_> {
    /// Brings a vertex to `place`, or another one if it is a corner's; which one, and how.
    pub fn reach(&mut self, vertex: u32, place: Point) -> Option<(u32, Arrival)> {
        if let Some(arrival) = self.bring(vertex, place) {
            return Some((vertex, arrival));
        }
        if !self.is_corner(vertex) {
            return None;
        }
        let mut others = self.patch.vertices_near(place, NEAR * self.lattice.voxel());
        others.retain(|&(v, _)| v != vertex && self.may_go(v, place));
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        others.into_iter().take(MOST_OTHERS).find_map(|(v, _)| Some((v, self.bring(v, place)?)))
    }

    /// Brings a vertex to `place`, if the surface is no farther from the triangles then: by itself, or by merging a
    /// neighbour into it that is in the way there.
    fn bring(&mut self, vertex: u32, place: Point) -> Option<Arrival> {
        let star = self.triangles_at(vertex);
        let limit = self.star_error(vertex, &star, f64::INFINITY).max(self.tolerance);
        let moved: Vec<PatchTriangle> = star.iter().map(|t| t.with(vertex, vertex, place)).collect();
        if self.star_error(vertex, &moved, limit) <= limit && self.patch.try_move(vertex, place) {
            return Some(Arrival::Moved);
        }
        let neighbours = vertices_of(&star);
        let mut candidates = Vec::with_capacity(neighbours.len());
        for lost in neighbours {
            if !self.may_go(lost, place) {
                continue;
            }
            let Some(star) = self.patch.star_if_collapsed([vertex, lost], place) else { continue };
            let error = self.star_error(vertex, &star, limit);
            if error <= limit {
                candidates.push((error, lost));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut lost = candidates.into_iter().map(|(_, lost)| lost);
        lost.any(|lost| self.patch.try_collapse([vertex, lost], place)).then_some(Arrival::Merged)
    }

    /// Merges a vertex whose corner another one has taken into a neighbour, or brings it to the surface, if it is far from there.
    /// Whether it was merged.
    pub fn retire(&mut self, vertex: u32) -> bool {
        let Some(from) = self.patch.position(vertex) else { return false };
        let error = self.error(from, &Sides::NONE);
        if error <= self.tolerance {
            return false;
        }
        let mut candidates = Vec::new();
        for kept in vertices_of(&self.triangles_at(vertex)) {
            let Some(to) = self.patch.position(kept) else { continue };
            let Some(star) = self.patch.star_if_collapsed([kept, vertex], to) else { continue };
            let then = self.star_error(kept, &star, MENDED * error);
            if then <= MENDED * error && self.may_go(vertex, to) {
                candidates.push((then, kept, to));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        if candidates.into_iter().any(|(_, kept, to)| self.patch.try_collapse([kept, vertex], to)) {
            return true;
        }
        if let Some(place) = self.place_on_surface(vertex) {
            self.patch.try_move(vertex, place);
        }
        false
    }

    fn triangles_at(&self, vertex: u32) -> Vec<PatchTriangle> {
        self.patch.star(vertex).into_iter().map(|n| *self.patch.triangle_at(n)).collect()
    }

    /// Whether a vertex stands for a corner.
    pub fn is_corner(&self, vertex: u32) -> bool {
        self.features.get(vertex).is_some_and(|f| f.feature.normals.iter().all(|n| *n != [0.0; 3]))
    }

    /// Merges the ends of sides of thin triangles at a vertex, as long as the surface is no farther from the triangles
    /// then.
    pub fn tidy_around(&mut self, vertex: u32) -> u64 {
        let mut merged = 0;
        while merged < MOST_MERGES {
            let star = self.patch.star(vertex);
            let thin = star.into_iter().filter(|&n| self.is_thin(n)).collect::<Vec<_>>();
            if !thin.into_iter().any(|n| self.tidy(n)) {
                break;
            }
            merged += 1;
        }
        merged
    }

    /// Whether a triangle at a vertex is thin.
    pub fn is_untidy(&self, vertex: u32) -> bool {
        self.patch.star(vertex).into_iter().any(|n| self.is_thin(n))
    }

    fn is_thin(&self, n: usize) -> bool {
        let [a, b, c] = self.patch.triangle_at(n).corners;
        let area = cross(along(b, -1.0, a), along(c, -1.0, a));
        let longest = distance2(a, b).max(distance2(b, c)).max(distance2(c, a));
        dot(area, area) < (THIN * self.lattice.voxel()).powi(2) * longest
    }

    /// Merges the ends of the shortest side of a thin triangle.
    fn tidy(&mut self, n: usize) -> bool {
        let [a, b, c] = self.patch.triangle_at(n).corners;
        let lengths = [distance2(a, b), distance2(b, c), distance2(c, a)];
        let shortest = if lengths[0] <= lengths[1].min(lengths[2]) {
            0
        } else if lengths[1] <= lengths[2] {
            1
        } else {
            2
        };
        let next = (shortest + 1) % 3;
        self.merge_side(n, &[[shortest, next], [next, shortest]], SMOOTH, 1.0).is_some()
    }

    /// Merges the ends of a side of a triangle that is far from the surface, if that brings it nearer. Returns the
    /// vertex that they became.
    pub fn mend(&mut self, n: usize) -> Option<u32> {
        self.merge_side(n, &[[0, 1], [1, 0], [1, 2], [2, 1], [2, 0], [0, 2]], 0.0, MENDED)
    }

    /// Merges the ends of a side of a triangle, given as the one that stays and the one that goes, if the error of the
    /// triangles around is then at most `smooth` or this share of what it is now.
    fn merge_side(&mut self, n: usize, sides: &[[usize; 2]], smooth: f64, share: f64) -> Option<u32> {
        let PatchTriangle { vertices, corners, .. } = *self.patch.triangle_at(n);
        let mut candidates = Vec::with_capacity(sides.len());
        for &[stays, goes] in sides {
            let (edge, to) = ([vertices[stays], vertices[goes]], corners[stays]);
            let Some(star) = self.patch.star_if_collapsed(edge, to) else { continue };
            if !self.may_go(edge[1], to) || !self.is_on(corners[goes], &star) {
                continue;
            }
            let then = self.star_error(edge[0], &star, f64::INFINITY);
            let is_acceptable = then <= smooth || {
                let star = self.triangles_at(edge[1]);
                let of_vertex = self.error(corners[goes], &Sides::NONE);
                then <= share * of_vertex.max(self.star_error(edge[1], &star, then / share))
            };
            if is_acceptable {
                candidates.push((then, edge, to));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        let merged = candidates.iter().find(|&&(_, edge, to)| self.patch.try_collapse(edge, to));
        merged.map(|(_, edge, _)| edge[0])
    }

    /// Whether a point is on triangles, nearly, or not on the surface anyway.
    fn is_on(&mut self, p: Point, triangles: &[PatchTriangle]) -> bool {
        let limit = (LOST * self.lattice.voxel()).powi(2);
        let is_near = |t: &PatchTriangle| {
            let corners = t.corners.map(DVec3::from);
            Triangle::new(corners, t.vertices).closest(DVec3::from(p)).distance_squared <= limit
        };
        triangles.iter().any(is_near) || self.error(p, &Sides::NONE) > LOST
    }

    /// Whether nothing is lost when a vertex is merged into another one at `place`: it is no corner, or the same one, or
    /// another vertex that stands for its corner is there.
    fn may_go(&self, vertex: u32, place: Point) -> bool {
        if !self.is_corner(vertex) {
            return true;
        }
        let same = SAME_CORNER * self.lattice.voxel();
        self.features.get(vertex).is_some_and(|FeatureVertex { feature, .. }| {
            let is_same = |p: Point| distance2(feature.point, p) <= same * same;
            let stands_for_it = |v: u32| {
                v != vertex
                    && self.is_corner(v)
                    && self.features.get(v).is_some_and(|f| is_same(f.feature.point))
            };
            is_same(place)
                || self.patch.vertices_near(feature.point, same).into_iter().any(|(v, _)| stands_for_it(v))
        })
    }

    /// How far the surface is from the triangles at a vertex, at most, in voxels, at the places that are looked at: as
    /// far as `enough` at least when it is farther than that. Their sides opposite to the vertex are not looked at.
    fn star_error(&mut self, vertex: u32, star: &[PatchTriangle], enough: f64) -> f64 {
        let mut worst = 0.0f64;
        for t in star {
            let Some(k) = t.vertices.iter().position(|&v| v == vertex) else { continue };
            let [a, b, c] = [0, 1, 2].map(|i| t.corners[(k + i) % 3]);
            let sides = self.sides(t);
            let centre = std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0);
            // The side to c is the one to b of the next triangle.
            for p in [middle(a, b), centre] {
                worst = worst.max(self.error(p, &sides));
            }
            if worst > enough {
                break;
            }
        }
        worst
    }
}

/// The vertices of some triangles, by number.
fn vertices_of(triangles: &[PatchTriangle]) -> Vec<u32> {
    let mut all: Vec<u32> = triangles.iter().flat_map(|t| t.vertices).collect();
    all.sort_unstable();
    all.dedup();
    all
}
