//! Local edits (moves, flips, splits) that bring the finished mesh closer to the surface.
//!
//! `patch` applies an edit only if an exact test shows that the mesh stays free of intersections.

use super::distance_cache::DistanceCache;
use super::patch::{Patch, PatchEdge, PatchTriangle};
use crate::contour::feature::{
    CreasePlanes, FeatureMap, SurfaceProbe, VertexSet, feature_between, project_to_surface,
};
use crate::contour::implicit_surface::ImplicitSurface;
use crate::contour::rounded_lattice::RoundedLattice;
use crate::contour::vertex::Cells;
use glam::DVec3;

/// The cosine between the normals of an edge's triangles above which the edge is not worth flipping
/// (5 degrees).
const FLAT: f64 = 0.996;

/// The distance of an edge's middle from the surface, in voxels, below which the edge stays.
const GOOD_EDGE: f64 = 0.01;

/// The distance of a point from the crease planes nearby, in voxels, below which the surface is not
/// sampled.
const SURE: f64 = 0.01;

/// The factor by which a flip must bring the middle of the edge nearer.
const FLIP_GAIN: f64 = 0.5;

/// The distance of a vertex from a point, in voxels, below which the point is taken.
const TAKEN: f64 = 0.01;

/// The shares of the way to its target that the vertex of a split tries: a triangle can be in the
/// way.
const SHARES: [f64; 4] = [1.0, 0.75, 0.5, 0.25];

/// The factor by which a part of the way must bring the vertex of a split nearer.
const PART_GAIN: f64 = 0.8;

/// The most splits around one vertex and around those that it adds.
///
/// Where the surface jumps, splits do not bring the mesh nearer, and would go on without end.
const MAX_SPLITS: u64 = 12;

/// The limit of flips around one vertex. Every flip brings the mesh nearer; the limit is for
/// rounding.
const MAX_FLIPS: u64 = 8;

/// Whether the crease planes nearby can decide that a point is near the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorSource {
    /// Crease planes first, then the surface.
    CreasePlanes,
    /// The surface alone.
    Surface,
}

/// The point at which a triangle is farthest from the surface.
#[derive(Clone, Copy, Debug)]
pub struct FarthestPoint {
    /// The edge in whose middle the point lies, 0 to 2; `None` for the centre of the triangle.
    edge: Option<usize>,
    point: DVec3,
    /// The distance from the surface, in voxels.
    error: f64,
}

/// Optimises a patch of the mesh by local edits.
pub struct PatchOptimizer<'a> {
    /// The part of the mesh.
    pub patch: Patch,
    /// The lattice, for the voxel size and the precision.
    pub lattice: &'a RoundedLattice,
    /// The vertices on creases and corners.
    pub features: &'a FeatureMap,
    /// The vertices of cells in which the sign jumps.
    pub jumps: &'a VertexSet,
    /// The distance from the surface, in voxels, above which triangles and edges are split, and
    /// vertices moved.
    pub tolerance: f64,
    /// The number of splits that may still be made.
    pub splits_left: u64,
    /// The number of vertices whose splits ended at a limit.
    pub given_up: u64,
    surface: &'a dyn ImplicitSurface,
    source: ErrorSource,
    /// The closest triangle of the last sample.
    hint: u32,
    /// Distances from the surface, in voxels.
    distances: DistanceCache,
}

impl<'a> PatchOptimizer<'a> {
    /// Makes an optimizer for a patch of the mesh of `cells`, with a tolerance in voxels.
    pub fn new(
        patch: Patch,
        surface: &'a dyn ImplicitSurface,
        cells: &'a Cells<'_>,
        tolerance: f64,
        source: ErrorSource,
    ) -> PatchOptimizer<'a> {
        PatchOptimizer {
            patch,
            lattice: &cells.context.lattice,
            features: &cells.features,
            jumps: &cells.jumps,
            tolerance,
            splits_left: u64::MAX,
            given_up: 0,
            surface,
            source,
            hint: 0,
            distances: DistanceCache::new(),
        }
    }
}

impl<'a> PatchOptimizer<'a> {
    /// Returns a probe of the surface around a point.
    fn probe(&self, origin: DVec3) -> SurfaceProbe<'a> {
        SurfaceProbe { surface: self.surface, origin, voxel: self.voxel(), triangle: self.hint }
    }

    /// Returns the rounded point of the surface near a vertex that is far from the surface; `None`
    /// for other vertices.
    pub fn surface_target(&mut self, vertex: u32) -> Option<[f64; 3]> {
        let origin = DVec3::from(self.patch.position(vertex)?);
        let mut probe = self.probe(origin);
        let is_far = probe.sample(DVec3::ZERO).0.abs() > self.tolerance;
        let target = if is_far { project_to_surface(&mut probe, DVec3::ZERO) } else { None };
        self.hint = probe.triangle;
        target.map(|p| self.lattice.round(origin + self.voxel() * p))
    }

    /// Flips edges at and around a vertex that cut through the solid or the air beside a crease.
    /// Returns the number of flips.
    pub fn flip_around(&mut self, vertex: u32) -> u64 {
        let mut flipped = 0;
        while flipped < MAX_FLIPS {
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
        let planes = self.features.crease_planes([a, b, c, d].map(|v| v.0).into_iter());
        let now = self.error(middle(a.1, b.1), &planes);
        if now < GOOD_EDGE {
            return None;
        }
        let then = self.error(middle(c.1, d.1), &CreasePlanes::NONE);
        (then < FLIP_GAIN * now && self.patch.try_flip(edge)).then_some(())
    }

    /// Splits the triangles at a vertex, and their edges, where they are far from the surface, then
    /// the triangles at the vertices that this adds. Returns the number of splits.
    pub fn split_around(&mut self, vertex: u32) -> u64 {
        let mut split = 0;
        let mut vertices = vec![vertex];
        let mut next = 0;
        while let Some(&vertex) = vertices.get(next) {
            next += 1;
            let mut pending = self.patch.star(vertex);
            while let Some(n) = pending.pop() {
                let Some(worst) = self.worst(n) else { continue };
                if split == MAX_SPLITS || self.splits_left == 0 {
                    self.given_up += 1;
                    return split;
                }
                let Some(new) = self.improve(n, worst) else { continue };
                split += 1;
                self.splits_left -= 1;
                vertices.push(new);
                self.flip_around(new);
                pending.retain(|&n| self.patch.triangle_at(n).vertices.contains(&vertex));
            }
        }
        split
    }

    /// Whether a triangle at a vertex is far from the surface.
    pub fn is_far_around(&mut self, vertex: u32) -> bool {
        self.patch.star(vertex).into_iter().any(|n| self.worst(n).is_some())
    }

    /// Returns the point at which a triangle is farthest from the surface, if that is beyond the
    /// tolerance and the sign does not jump there.
    pub fn worst(&mut self, n: usize) -> Option<FarthestPoint> {
        if self.jumps.contains_any(self.patch.triangle_at(n).vertices) {
            return None;
        }
        self.farthest(n).filter(|farthest| farthest.error > self.tolerance)
    }

    /// Whether a triangle is farther from the surface than the tolerance.
    pub fn is_beyond(&mut self, n: usize) -> bool {
        self.farthest(n).is_some_and(|farthest| farthest.error > self.tolerance)
    }

    /// Returns the farthest of the points of a triangle that are looked at: the middles of its
    /// edges, and its centre.
    fn farthest(&mut self, n: usize) -> Option<FarthestPoint> {
        let t = *self.patch.triangle_at(n);
        let [a, b, c] = t.corners.map(DVec3::from);
        let points = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0];
        let planes = self.crease_planes(&t);
        let errors = points.map(|p| self.error(p, &planes));
        let worst = (0..4).max_by(|&i, &j| errors[i].total_cmp(&errors[j]))?;
        let edge = (worst < 3).then_some(worst);
        Some(FarthestPoint { edge, point: points[worst], error: errors[worst] })
    }

    /// Splits a triangle, or an edge of it, where it is farthest from the surface, or collapses an
    /// edge of it if that is not possible. Returns the vertex around which the triangles have
    /// changed.
    pub fn improve(&mut self, n: usize, farthest: FarthestPoint) -> Option<u32> {
        self.split(n, farthest).or_else(|| self.collapse_to_improve(n))
    }

    fn split(&mut self, n: usize, farthest: FarthestPoint) -> Option<u32> {
        let from = farthest.point;
        let edge = farthest.edge.and_then(|k| self.patch.edge(n, k));
        let around: Vec<[f64; 3]> = match &edge {
            Some(edge) => vec![edge.a.1, edge.b.1, edge.c.1, edge.d.1],
            None => self.patch.triangle_at(n).corners.into(),
        };
        let targets = self.split_targets(from, &around);
        for (share, target) in SHARES.into_iter().flat_map(|share| targets.map(|target| (share, target))) {
            let Some(target) = target else { continue };
            let target = self.lattice.round(from + share * (target - from));
            // Part of the way to a crease can lead away from the surface.
            if share < 1.0 {
                let planes = CreasePlanes::NONE;
                let then = self.error(target.into(), &planes);
                if then > PART_GAIN * self.error(from, &planes) {
                    continue;
                }
            }
            if self.patch.is_taken(target, TAKEN * self.voxel()) {
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

    /// Returns points of the surface near `from`: the crease or corner between the smooth faces
    /// that are seen from there towards the points around, and the point that gradients lead to.
    fn split_targets(&mut self, from: DVec3, around: &[[f64; 3]]) -> [Option<DVec3>; 2] {
        let voxel = self.voxel();
        let mut probe = self.probe(from);
        let towards = around.iter().map(|&p| 0.5 * (DVec3::from(p) - from) / voxel);
        let crease = feature_between(&mut probe, towards);
        let next = project_to_surface(&mut probe, DVec3::ZERO);
        self.hint = probe.triangle;
        [crease, next].map(|local| local.map(|p| from + voxel * p))
    }

    /// Returns the planes of the features at the vertices of a triangle, if they may decide.
    pub fn crease_planes(&self, t: &PatchTriangle) -> CreasePlanes {
        match self.source {
            ErrorSource::CreasePlanes => self.features.crease_planes(t.vertices.into_iter()),
            ErrorSource::Surface => CreasePlanes::NONE,
        }
    }

    /// Returns the voxel size in model units.
    pub fn voxel(&self) -> f64 {
        self.lattice.voxel()
    }

    /// Returns the distance of a point from the surface, in voxels; 0 where it is less than
    /// [`SURE`] by the crease planes near the point.
    pub fn error(&mut self, p: DVec3, planes: &CreasePlanes) -> f64 {
        if !planes.is_empty() && planes.distance(p.to_array()) < SURE * self.voxel() {
            return 0.0;
        }
        let (surface, hint, voxel) = (self.surface, &mut self.hint, self.lattice.voxel());
        self.distances.get(p, || {
            let sample = surface.sample(p, *hint);
            *hint = sample.triangle;
            sample.distance.abs() / voxel
        })
    }
}

/// Returns the middle of a segment.
pub fn middle(a: [f64; 3], b: [f64; 3]) -> DVec3 {
    0.5 * (DVec3::from(a) + DVec3::from(b))
}

/// Whether the triangles of an edge have nearly the same normal.
fn is_flat(edge: &PatchEdge) -> bool {
    let [a, b, c, d] = [edge.a, edge.b, edge.c, edge.d].map(|v| DVec3::from(v.1));
    let along = b - a;
    let (n, m) = (along.cross(c - a), (d - a).cross(along));
    n.dot(m) > FLAT * (n.length_squared() * m.length_squared()).sqrt()
}
