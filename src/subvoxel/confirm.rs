//! Confirms candidates against the finished mesh.
//!
//! Tips of creases beyond the cells that see them are recovered after the search, so some
//! candidates are on the right side of the mesh in the end.

use super::search::{Missed, MissedCandidate, MissedCandidates};
use crate::geom::triangle::Triangle;
use crate::lattice::{Ijk, LEAF_DIM, Lattice, LeafIndex};
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings, SHARE};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Depth on the wrong side of the mesh, in voxels, up to which a candidate is part of the mesh's
/// error.
pub(super) const MIN_DEPTH: f64 = 0.05;

/// Largest distance, in voxels, of a triangle that decides about a candidate. Where no triangle is
/// that near, the nodes around the candidate decide.
const MAX_DISTANCE: f64 = 2.0;

/// Keeps the candidates that are on the wrong side of `mesh`.
///
/// `mesh` is the result, or the part of it around the candidates. `leaves` gives the range of its
/// triangles by the origin of their leaf; a triangle reaches at most `stray` voxels beyond its
/// leaf.
///
/// # Errors
/// When the run is cancelled.
pub fn confirm_missed(
    candidates: MissedCandidates,
    mesh: &TriMesh,
    leaves: impl Iterator<Item = (Ijk, Range<usize>)>,
    stray: f64,
    run: &RunSettings,
) -> Result<MissedCandidates, Cancelled> {
    let MissedCandidates { all, lattice: Some(lattice) } = candidates else { return Ok(candidates) };
    if all.is_empty() {
        return Ok(MissedCandidates { all, lattice: Some(lattice) });
    }
    let near = NearMesh::new(&all, lattice);
    let around = LeafIndex::new(&around(&all, lattice, stray));
    let leaves: Vec<_> = leaves.filter(|(origin, _)| around.get(*origin).is_some()).collect();
    let nearest = run.install(|| near.nearest_triangles(mesh, &leaves, run))?;
    let missed = all.iter().zip(nearest).filter(|(candidate, nearest)| nearest.is_missed(candidate, lattice));
    Ok(MissedCandidates { all: missed.map(|(candidate, _)| *candidate).collect(), lattice: Some(lattice) })
}

/// The triangle of the mesh that is nearest to a candidate.
#[derive(Clone, Copy)]
struct Nearest {
    distance: f64,
    /// Cosine between the triangle's normal and the way to the candidate. Of triangles that meet in
    /// the closest point, the one with the largest cosine in size knows the candidate's side.
    cosine: f64,
}

impl Nearest {
    const NONE: Nearest = Nearest { distance: f64::INFINITY, cosine: 0.0 };

    fn is_missed(&self, candidate: &MissedCandidate, lattice: Lattice) -> bool {
        if self.distance > MAX_DISTANCE * lattice.voxel {
            return true;
        }
        let is_wrong = match candidate.missed {
            Missed::Solid => self.cosine > 0.0,
            Missed::Void => self.cosine < 0.0,
        };
        is_wrong && self.distance > MIN_DEPTH * lattice.voxel
    }

    fn nearer(self, other: Nearest, slack: f64) -> Nearest {
        let as_near = (self.distance - other.distance).abs() <= slack;
        if as_near && other.cosine.abs() > self.cosine.abs() || !as_near && other.distance < self.distance {
            other
        } else {
            self
        }
    }
}

/// The candidates, by the leaf of their cells.
struct NearMesh<'a> {
    candidates: &'a [MissedCandidate],
    lattice: Lattice,
    index: LeafIndex,
    by_leaf: Vec<Vec<u32>>,
}

impl<'a> NearMesh<'a> {
    fn new(candidates: &'a [MissedCandidate], lattice: Lattice) -> NearMesh<'a> {
        let mut origins: Vec<Ijk> = candidates.iter().map(|s| s.cell.leaf_origin()).collect();
        origins.sort_unstable();
        origins.dedup();
        let index = LeafIndex::new(&origins);
        let mut by_leaf = vec![Vec::new(); origins.len()];
        for (candidate, n) in candidates.iter().zip(0..) {
            by_leaf[index.get(candidate.cell).expect("its own leaf")].push(n);
        }
        NearMesh { candidates, lattice, index, by_leaf }
    }

    /// Returns the nearest triangle to each candidate, of the triangles of `leaves`.
    fn nearest_triangles(
        &self,
        mesh: &TriMesh,
        leaves: &[(Ijk, Range<usize>)],
        run: &RunSettings,
    ) -> Result<Vec<Nearest>, Cancelled> {
        let pairs: Vec<Vec<(u32, Nearest)>> = leaves
            .par_iter()
            .with_min_len(16)
            .with_max_len(SHARE)
            .map(|(_, triangles)| {
                run.check()?;
                let mut pairs = Vec::new();
                for n in triangles.clone() {
                    let corners = mesh.corners(n).map(DVec3::from);
                    self.triangle(corners, mesh.triangles[n], &mut pairs);
                }
                Ok(pairs)
            })
            .collect::<Result<_, Cancelled>>()?;
        let mut nearest = vec![Nearest::NONE; self.candidates.len()];
        let slack = 1e-6 * self.lattice.voxel;
        for (candidate, found) in pairs.into_iter().flatten() {
            let own = &mut nearest[candidate as usize];
            *own = own.nearer(found, slack);
        }
        Ok(nearest)
    }

    fn triangle(&self, corners: [DVec3; 3], vertices: [u32; 3], pairs: &mut Vec<(u32, Nearest)>) {
        let margin = MAX_DISTANCE * self.lattice.voxel;
        let [a, b, c] = corners;
        let (lo, hi) = (a.min(b).min(c) - margin, a.max(b).max(c) + margin);
        for leaf in leaves_between(lo, hi, self.lattice).filter_map(|leaf| self.index.get(leaf)) {
            for &n in &self.by_leaf[leaf] {
                let p = self.candidates[n as usize].at;
                if p.cmplt(lo).any() || p.cmpgt(hi).any() {
                    continue;
                }
                let triangle = Triangle::new(corners, vertices);
                let closest = triangle.closest(p);
                let distance = closest.distance_squared.sqrt();
                let cosine = (p - closest.point).dot(triangle.normal) / distance.max(f64::MIN_POSITIVE);
                pairs.push((n, Nearest { distance, cosine }));
            }
        }
    }
}

/// Returns the leaves whose triangles can be near enough to a candidate, ascending.
fn around(candidates: &[MissedCandidate], lattice: Lattice, stray: f64) -> Vec<Ijk> {
    // One more voxel for rounding.
    let margin = (MAX_DISTANCE + stray + 1.0) * lattice.voxel;
    let of = |s: &MissedCandidate| leaves_between(s.at - margin, s.at + margin, lattice);
    let mut leaves: Vec<Ijk> = candidates.iter().flat_map(of).collect();
    leaves.sort_unstable();
    leaves.dedup();
    leaves
}

/// Returns the origin of the leaf that holds a point.
fn leaf_at(p: DVec3, lattice: Lattice) -> Ijk {
    Ijk((p / lattice.voxel).floor().as_ivec3().to_array()).leaf_origin()
}

/// Returns the origins of the leaves that the box from `lo` to `hi` touches, z fastest.
fn leaves_between(lo: DVec3, hi: DVec3, lattice: Lattice) -> impl Iterator<Item = Ijk> {
    let (first, last) = (leaf_at(lo, lattice).0, leaf_at(hi, lattice).0);
    let along = move |axis: usize| (first[axis]..=last[axis]).step_by(LEAF_DIM as usize);
    along(0).flat_map(move |x| along(1).flat_map(move |y| along(2).map(move |z| Ijk([x, y, z]))))
}
