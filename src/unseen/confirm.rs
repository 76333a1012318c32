//! Which suspects the finished mesh knows: tips of creases beyond the cells that see them are recovered afterwards.

use super::suspects::{Hidden, Suspect, Suspects};
use crate::geom::triangle::Triangle;
use crate::lattice::{Ijk, LEAF_DIM, Lattice, LeafIndex};
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings, SHARE};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// A suspect that is on the wrong side of the mesh by less than this, in voxels, is part of its error.
pub(super) const DEEP: f64 = 0.05;

/// Triangles farther than this from a suspect, in voxels, say nothing of it: the nodes around it do.
const REACH: f64 = 2.0;

/// Keeps the suspects that `mesh`, the result or the part of it around them, has on the wrong side. `leaves` gives the
/// numbers of its triangles by the origin of their leaf, beyond which they reach by at most `stray` voxels.
///
/// # Errors
/// When the run is cancelled.
pub fn lost(
    suspects: Suspects,
    mesh: &TriMesh,
    leaves: impl Iterator<Item = (Ijk, Range<usize>)>,
    stray: f64,
    run: &RunSettings,
) -> Result<Suspects, Cancelled> {
    let Suspects { all, lattice: Some(lattice) } = suspects else { return Ok(suspects) };
    if all.is_empty() {
        return Ok(Suspects { all, lattice: Some(lattice) });
    }
    let near = NearMesh::new(&all, lattice);
    let around = LeafIndex::new(&around(&all, lattice, stray));
    let leaves: Vec<_> = leaves.filter(|(origin, _)| around.get(*origin).is_some()).collect();
    let seen = run.install(|| near.look(mesh, &leaves, run))?;
    let lost = all.iter().zip(seen).filter(|(suspect, nearest)| nearest.is_lost(suspect, lattice));
    Ok(Suspects { all: lost.map(|(suspect, _)| *suspect).collect(), lattice: Some(lattice) })
}

/// The nearest triangle of the mesh to a suspect.
#[derive(Clone, Copy)]
struct Nearest {
    distance: f64,
    /// The cosine between its normal and the way to the suspect. Of triangles that meet in the closest point, the one
    /// that looks most at the suspect knows its side.
    cosine: f64,
}

impl Nearest {
    const NONE: Nearest = Nearest { distance: f64::INFINITY, cosine: 0.0 };

    fn is_lost(&self, suspect: &Suspect, lattice: Lattice) -> bool {
        if self.distance > REACH * lattice.voxel {
            return true;
        }
        let is_wrong = match suspect.hidden {
            Hidden::Solid => self.cosine > 0.0,
            Hidden::Air => self.cosine < 0.0,
        };
        is_wrong && self.distance > DEEP * lattice.voxel
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

/// The suspects by leaf of their cells.
struct NearMesh<'a> {
    suspects: &'a [Suspect],
    lattice: Lattice,
    index: LeafIndex,
    by_leaf: Vec<Vec<u32>>,
}

impl<'a> NearMesh<'a> {
    fn new(suspects: &'a [Suspect], lattice: Lattice) -> NearMesh<'a> {
        let mut origins: Vec<Ijk> = suspects.iter().map(|s| s.cell.leaf_origin()).collect();
        origins.sort_unstable();
        origins.dedup();
        let index = LeafIndex::new(&origins);
        let mut by_leaf = vec![Vec::new(); origins.len()];
        for (suspect, n) in suspects.iter().zip(0..) {
            by_leaf[index.get(suspect.cell).expect("its own leaf")].push(n);
        }
        NearMesh { suspects, lattice, index, by_leaf }
    }

    /// The nearest triangle within reach of each suspect, of those of some leaves.
    fn look(
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
        let mut nearest = vec![Nearest::NONE; self.suspects.len()];
        let slack = 1e-6 * self.lattice.voxel;
        for (suspect, found) in pairs.into_iter().flatten() {
            let own = &mut nearest[suspect as usize];
            *own = own.nearer(found, slack);
        }
        Ok(nearest)
    }

    fn triangle(&self, corners: [DVec3; 3], vertices: [u32; 3], pairs: &mut Vec<(u32, Nearest)>) {
        let reach = REACH * self.lattice.voxel;
        let [a, b, c] = corners;
        let (lo, hi) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
        for leaf in leaves_between(lo, hi, self.lattice).filter_map(|leaf| self.index.get(leaf)) {
            for &n in &self.by_leaf[leaf] {
                let p = self.suspects[n as usize].at;
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

/// The leaves whose triangles can be within reach of suspects, ascending.
fn around(suspects: &[Suspect], lattice: Lattice, stray: f64) -> Vec<Ijk> {
    // And a voxel, for rounding.
    let margin = (REACH + stray + 1.0) * lattice.voxel;
    let of = |s: &Suspect| leaves_between(s.at - margin, s.at + margin, lattice);
    let mut leaves: Vec<Ijk> = suspects.iter().flat_map(of).collect();
    leaves.sort_unstable();
    leaves.dedup();
    leaves
}

/// The origin of the leaf that a point lies in.
fn leaf_at(p: DVec3, lattice: Lattice) -> Ijk {
    Ijk((p / lattice.voxel).floor().as_ivec3().to_array()).leaf_origin()
}

/// The origins of the leaves that the box from `lo` to `hi` touches, z fastest.
fn leaves_between(lo: DVec3, hi: DVec3, lattice: Lattice) -> impl Iterator<Item = Ijk> {
    let (first, last) = (leaf_at(lo, lattice).0, leaf_at(hi, lattice).0);
    let along = move |axis: usize| (first[axis]..=last[axis]).step_by(LEAF_DIM as usize);
    along(0).flat_map(move |x| along(1).flat_map(move |y| along(2).map(move |z| Ijk([x, y, z]))))
}
