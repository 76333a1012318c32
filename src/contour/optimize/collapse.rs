//! Edge collapses: slivers removed, triangles brought nearer to the surface, and vertices moved
//! where another one is in the way.

use super::optimizer::{PatchOptimizer, middle};
use super::patch::PatchTriangle;
use crate::contour::feature::{CreasePlanes, FeatureVertex};
use crate::geom::triangle::Triangle;
use glam::DVec3;

/// The distance between two corners, in voxels, below which they are one: two cells have located
/// it, each with a rounding of its own.
const SAME_CORNER: f64 = 1e-3;

/// The height of a triangle, in voxels, below which it is a sliver.
const SLIVER_HEIGHT: f64 = 0.05;

/// The distance from the surface, in voxels, that triangles around a collapsed sliver may have in
/// any case.
const SLIVER_ERROR: f64 = 0.01;

/// The distance from a corner, in voxels, within which another vertex can be moved there instead.
const SUBSTITUTE_RADIUS: f64 = 1.0;

/// The most vertices that are tried as substitutes.
const MAX_SUBSTITUTES: usize = 6;

/// The factor by which a collapse that is to bring triangles nearer to the surface must do so.
const COLLAPSE_GAIN: f64 = 0.5;

/// The most collapses around one vertex. Each takes two triangles away.
const MAX_COLLAPSES: u64 = 8;

/// The distance from the triangles, in voxels, at which a removed vertex may leave the surface
/// uncovered.
///
/// With more, corners that no feature remembers are cut off.
const MAX_UNCOVERED: f64 = 2e-3;

/// The way in which a vertex came to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RelocationKind {
    /// By a move.
    Moved,
    /// By collapsing an edge to it.
    Collapsed,
}

/// The collapse of an edge of a triangle, by the places of its ends in the triangle.
#[derive(Clone, Copy, Debug)]
struct EdgeEnds {
    kept: usize,
    removed: usize,
}

impl PatchOptimizer<'_> {
    /// Relocates a vertex to `target`, or a substitute for it if the target is a corner. Returns
    /// the vertex that is there now, and the way it came.
    pub fn relocate_or_substitute(&mut self, vertex: u32, target: [f64; 3]) -> Option<(u32, RelocationKind)> {
        if let Some(kind) = self.relocate_with_collapse(vertex, target) {
            return Some((vertex, kind));
        }
        if !self.is_corner(vertex) {
            return None;
        }
        let mut others = self.patch.vertices_near(target, SUBSTITUTE_RADIUS * self.voxel());
        others.retain(|&(v, _)| v != vertex && self.can_remove(v, target));
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut others = others.into_iter().take(MAX_SUBSTITUTES);
        others.find_map(|(v, _)| Some((v, self.relocate_with_collapse(v, target)?)))
    }

    /// Relocates a vertex to `target` if the triangles are no farther from the surface then: by a
    /// move, or by collapsing an edge to a neighbour that is in the way.
    fn relocate_with_collapse(&mut self, vertex: u32, target: [f64; 3]) -> Option<RelocationKind> {
        let star = self.triangles_at(vertex);
        let limit = self.star_error(vertex, &star, f64::INFINITY).max(self.tolerance);
        let moved: Vec<PatchTriangle> = star.iter().map(|t| t.with(vertex, vertex, target)).collect();
        if self.star_error(vertex, &moved, limit) <= limit && self.patch.try_move(vertex, target) {
            return Some(RelocationKind::Moved);
        }
        let neighbours = vertices_of(&star);
        let mut candidates = Vec::with_capacity(neighbours.len());
        for removed in neighbours {
            if !self.can_remove(removed, target) {
                continue;
            }
            let Some(star) = self.patch.star_if_collapsed([vertex, removed], target) else { continue };
            let error = self.star_error(vertex, &star, limit);
            if error <= limit {
                candidates.push((error, removed));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut removed = candidates.into_iter().map(|(_, removed)| removed);
        removed
            .any(|removed| self.patch.try_collapse([vertex, removed], target))
            .then_some(RelocationKind::Collapsed)
    }

    /// Removes a vertex whose corner another one has taken, if it is far from the surface: by
    /// collapsing an edge to a neighbour, else by moving it to the surface. Returns whether it was
    /// removed.
    pub fn remove_redundant(&mut self, vertex: u32) -> bool {
        let Some(from) = self.patch.position(vertex) else { return false };
        let error = self.error(from.into(), &CreasePlanes::NONE);
        if error <= self.tolerance {
            return false;
        }
        let mut candidates = Vec::new();
        for kept in vertices_of(&self.triangles_at(vertex)) {
            let Some(to) = self.patch.position(kept) else { continue };
            let Some(star) = self.patch.star_if_collapsed([kept, vertex], to) else { continue };
            let then = self.star_error(kept, &star, COLLAPSE_GAIN * error);
            if then <= COLLAPSE_GAIN * error && self.can_remove(vertex, to) {
                candidates.push((then, kept, to));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        if candidates.into_iter().any(|(_, kept, to)| self.patch.try_collapse([kept, vertex], to)) {
            return true;
        }
        if let Some(target) = self.surface_target(vertex) {
            self.patch.try_move(vertex, target);
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

    /// Collapses edges of the slivers at a vertex, as long as the triangles are no farther from the
    /// surface then. Returns the number of collapses.
    pub fn collapse_slivers_around(&mut self, vertex: u32) -> u64 {
        let mut collapsed = 0;
        while collapsed < MAX_COLLAPSES {
            let star = self.patch.star(vertex);
            let slivers: Vec<usize> = star.into_iter().filter(|&n| self.is_sliver(n)).collect();
            if !slivers.into_iter().any(|n| self.collapse_sliver(n)) {
                break;
            }
            collapsed += 1;
        }
        collapsed
    }

    /// Whether a triangle at a vertex is a sliver.
    pub fn has_sliver(&self, vertex: u32) -> bool {
        self.patch.star(vertex).into_iter().any(|n| self.is_sliver(n))
    }

    fn is_sliver(&self, n: usize) -> bool {
        let [a, b, c] = self.patch.triangle_at(n).corners.map(DVec3::from);
        let doubled_area2 = (b - a).cross(c - a).length_squared();
        let longest2 = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        doubled_area2 < (SLIVER_HEIGHT * self.voxel()).powi(2) * longest2
    }

    /// Collapses the shortest edge of a sliver.
    fn collapse_sliver(&mut self, n: usize) -> bool {
        let [a, b, c] = self.patch.triangle_at(n).corners.map(DVec3::from);
        let lengths2 = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        let shortest = if lengths2[0] <= lengths2[1].min(lengths2[2]) {
            0
        } else if lengths2[1] <= lengths2[2] {
            1
        } else {
            2
        };
        let next = (shortest + 1) % 3;
        let ends = [EdgeEnds { kept: shortest, removed: next }, EdgeEnds { kept: next, removed: shortest }];
        self.collapse_edge(n, &ends, SLIVER_ERROR, 1.0).is_some()
    }

    /// Collapses an edge of a triangle that is far from the surface, if that brings it nearer.
    /// Returns the vertex that remains.
    pub fn collapse_to_improve(&mut self, n: usize) -> Option<u32> {
        const ENDS: [[usize; 2]; 6] = [[0, 1], [1, 0], [1, 2], [2, 1], [2, 0], [0, 2]];
        self.collapse_edge(n, &ENDS.map(|[kept, removed]| EdgeEnds { kept, removed }), 0.0, COLLAPSE_GAIN)
    }

    /// Collapses one of the given edges of a triangle, if the error of the triangles around is then
    /// at most `good_error`, in voxels, or at most this share of what it is now. Returns the vertex
    /// that remains.
    fn collapse_edge(&mut self, n: usize, ends: &[EdgeEnds], good_error: f64, share: f64) -> Option<u32> {
        let PatchTriangle { vertices, corners, .. } = *self.patch.triangle_at(n);
        let mut candidates = Vec::with_capacity(ends.len());
        for &EdgeEnds { kept, removed } in ends {
            let (edge, to) = ([vertices[kept], vertices[removed]], corners[kept]);
            let Some(star) = self.patch.star_if_collapsed(edge, to) else { continue };
            let from = DVec3::from(corners[removed]);
            if !self.can_remove(edge[1], to) || !self.is_covered(from, &star) {
                continue;
            }
            let then = self.star_error(edge[0], &star, f64::INFINITY);
            let is_acceptable = then <= good_error || {
                let star = self.triangles_at(edge[1]);
                let of_vertex = self.error(from, &CreasePlanes::NONE);
                then <= share * of_vertex.max(self.star_error(edge[1], &star, then / share))
            };
            if is_acceptable {
                candidates.push((then, edge, to));
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
        let collapsed = candidates.iter().find(|&&(_, edge, to)| self.patch.try_collapse(edge, to));
        collapsed.map(|(_, edge, _)| edge[0])
    }

    /// Whether a point lies on triangles, nearly, or is not on the surface anyway.
    fn is_covered(&mut self, p: DVec3, triangles: &[PatchTriangle]) -> bool {
        let limit = (MAX_UNCOVERED * self.voxel()).powi(2);
        let is_near = |t: &PatchTriangle| {
            let corners = t.corners.map(DVec3::from);
            Triangle::new(corners, t.vertices).closest(p).distance_squared <= limit
        };
        triangles.iter().any(is_near) || self.error(p, &CreasePlanes::NONE) > MAX_UNCOVERED
    }

    /// Whether no corner is lost when a vertex is removed by an edge collapse to `target`.
    ///
    /// That is so if the vertex stands for no corner, if the corner is at the target, or if another
    /// vertex that stands for the corner is there.
    fn can_remove(&self, vertex: u32, target: [f64; 3]) -> bool {
        if !self.is_corner(vertex) {
            return true;
        }
        let same = SAME_CORNER * self.voxel();
        self.features.get(vertex).is_some_and(|FeatureVertex { feature, .. }| {
            let is_same = |p: DVec3| feature.point.distance_squared(p) <= same * same;
            let stands_for_it = |v: u32| {
                v != vertex
                    && self.is_corner(v)
                    && self.features.get(v).is_some_and(|f| is_same(f.feature.point))
            };
            let corner = feature.point.to_array();
            is_same(target.into())
                || self.patch.vertices_near(corner, same).into_iter().any(|(v, _)| stands_for_it(v))
        })
    }

    /// Returns the largest distance from the surface, in voxels, of the points of the triangles at
    /// a vertex that are looked at. The middles of the edges opposite to the vertex are left out.
    ///
    /// Where the distance is more than `enough`, a lower bound above `enough` is returned.
    fn star_error(&mut self, vertex: u32, star: &[PatchTriangle], enough: f64) -> f64 {
        let mut worst = 0.0f64;
        for t in star {
            let Some(k) = t.vertices.iter().position(|&v| v == vertex) else { continue };
            let [a, b, c] = [0, 1, 2].map(|i| t.corners[(k + i) % 3]);
            let planes = self.crease_planes(t);
            let centre = (DVec3::from(a) + DVec3::from(b) + DVec3::from(c)) / 3.0;
            // The edge to c is the one to b of the next triangle.
            for p in [middle(a, b), centre] {
                worst = worst.max(self.error(p, &planes));
            }
            if worst > enough {
                break;
            }
        }
        worst
    }
}

/// Returns the vertices of some triangles, by number.
fn vertices_of(triangles: &[PatchTriangle]) -> Vec<u32> {
    let mut all: Vec<u32> = triangles.iter().flat_map(|t| t.vertices).collect();
    all.sort_unstable();
    all.dedup();
    all
}
