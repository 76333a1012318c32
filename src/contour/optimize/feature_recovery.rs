//! Creases and corners that lie outside of the cells that see them.
//!
//! The construction keeps every vertex in its cell, and blunts features there that pass beside it:
//! the tip of a wedge that is thinner than a voxel, a corner between the nodes. When the mesh is
//! finished, such vertices are relocated to their targets. Neighbours that are in the way are
//! merged into them by edge collapses, edges are flipped along the crease, and triangles that are
//! still far from the surface are split. Each edit is made only if the mesh stays embedded (see
//! `patch`).
//!
//! All vertices are relocated first, then the rest is repaired: a split that is made before the
//! vertices around it are in place is in their way later.

use super::collapse::RelocationKind;
use super::optimizer::{ErrorSource, PatchOptimizer};
use super::patch::Bounds;
use super::schedule::for_each_patch;
use crate::contour::feature::CreasePlanes;
use crate::contour::implicit_surface::ImplicitSurface;
use crate::contour::mesh::LeafMesh;
use crate::contour::vertex::{Cells, Relocation};
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;

/// The distance from the surface, in voxels, above which triangles and edges around features are
/// split.
const TOLERANCE: f64 = 0.03;

/// The most splits for each cell of a leaf in one pass.
///
/// Models with a crease in every cell take 1.2 (armadillo at 64 voxels). Where more are asked for,
/// the surface has its features at a scale that the lattice does not, and has no end of them.
const SPLITS_PER_CELL: usize = 4;

/// The shares of the way to its target that a vertex tries if it cannot go all of it.
const SHARES: [f64; 4] = [0.98, 0.9, 0.75, 0.5];

/// Counts of what became of the relocations.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recovered {
    /// Vertices moved to their targets.
    pub moved: u64,
    /// Vertices that got half-way only, or stayed.
    pub refused: u64,
    /// Vertices removed because they were in the way.
    pub merged: u64,
    /// Edges flipped.
    pub flipped: u64,
    /// Triangles and edges split.
    pub split: u64,
    /// Vertices around which splits ended at a limit, with the surface still far.
    pub given_up: u64,
}

/// The work of one pass over the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pass {
    /// Moves vertices to their targets.
    Relocate,
    /// Does so once more, and repairs what is still far from the surface.
    Repair,
}

/// The passes over the mesh.
///
/// A leaf that is far from a neighbour's changes in one pass can be beside them in the next, so the
/// rest is repaired twice. A third time would gain a tenth of that.
const PASSES: [Pass; 3] = [Pass::Relocate, Pass::Repair, Pass::Repair];

/// The number of passes over the mesh.
pub const RECOVERY_PASSES: usize = PASSES.len();

/// A relocation that is not done yet, with its target.
#[derive(Clone, Copy, Debug)]
struct Pending {
    vertex: u32,
    target: [f64; 3],
}

/// Moves vertices of the finished mesh to their targets, and brings the mesh around them closer to
/// the surface. `relocations` has a list for each leaf.
///
/// # Errors
/// When the run is cancelled.
pub fn recover(
    cells: &Cells<'_>,
    surface: &dyn ImplicitSurface,
    relocations: &[Vec<Relocation>],
    mesh: &mut LeafMesh,
    run: &RunSettings,
) -> Result<Recovered, Cancelled> {
    let context = &cells.context;
    let mut recovered = Recovered::default();
    // By leaf the number of refused relocations, and whether there is something left to do.
    let mut states: Vec<(u64, bool)> = relocations.iter().map(|own| (0, !own.is_empty())).collect();
    for pass in PASSES {
        let mut next = states.clone();
        for_each_patch(
            mesh,
            context,
            context.signs.leaves().filter(|leaf| states[leaf.0 as usize].1),
            run,
            |mesh, leaf| {
                let positions =
                    |r: &Relocation| r.target.into_iter().chain([mesh.mesh.vertices[r.vertex as usize]]);
                Some(Bounds::around(relocations[leaf.0 as usize].iter().flat_map(positions)))
            },
            |leaf, patch| {
                let source = ErrorSource::CreasePlanes;
                let mut optimizer = PatchOptimizer::new(patch, surface, cells, TOLERANCE, source);
                optimizer.splits_left = (SPLITS_PER_CELL * context.numbers.range(leaf).len()) as u64;
                let done = optimizer.run_pass(&relocations[leaf.0 as usize], pass);
                (optimizer.patch, (leaf, done))
            },
            |(leaf, (done, is_pending))| {
                next[leaf.0 as usize] = (done.refused, is_pending);
                if !context.owns(leaf) {
                    return;
                }
                recovered.moved += done.moved;
                recovered.merged += done.merged;
                recovered.flipped += done.flipped;
                recovered.split += done.split;
                recovered.given_up += done.given_up;
            },
        )?;
        states = next;
    }
    let owned = context.signs.leaves().zip(&states).filter(|(leaf, _)| context.owns(*leaf));
    recovered.refused = owned.map(|(_, (refused, _))| refused).sum();
    Ok(recovered)
}

impl PatchOptimizer<'_> {
    /// Runs one pass over the relocations of a leaf. Returns counts, and whether something is left
    /// to do.
    fn run_pass(&mut self, relocations: &[Relocation], pass: Pass) -> (Recovered, bool) {
        let mut recovered = Recovered::default();
        let mut pending = self.pending(relocations);
        self.move_all(relocations, &mut pending, &mut recovered);
        self.relocate_by_collapse(&mut pending, &mut recovered);
        if pass == Pass::Repair {
            for &Pending { vertex, target } in &pending {
                self.move_part_way(vertex, target);
            }
            for relocation in relocations {
                recovered.split += self.split_around(relocation.vertex);
            }
            self.relocate_by_collapse(&mut pending, &mut recovered);
            for relocation in relocations {
                let merged = self.collapse_slivers_around(relocation.vertex);
                if merged > 0 {
                    recovered.merged += merged;
                    recovered.flipped += self.flip_around(relocation.vertex);
                }
            }
        }
        recovered.refused = pending.len() as u64;
        recovered.given_up = self.given_up;
        let is_pending = !pending.is_empty()
            || match pass {
                Pass::Relocate => {
                    relocations.iter().any(|r| self.is_far_around(r.vertex) || self.has_sliver(r.vertex))
                }
                Pass::Repair => recovered.split > 0,
            };
        (recovered, is_pending)
    }

    /// Returns the vertices that are not at their targets: corners first, since creases can go
    /// around them.
    fn pending(&mut self, relocations: &[Relocation]) -> Vec<Pending> {
        let mut pending: Vec<Pending> = Vec::with_capacity(relocations.len());
        for &Relocation { vertex, target } in relocations {
            let Some(position) = self.patch.position(vertex) else { continue };
            let target = target.or_else(|| self.surface_target(vertex));
            pending.extend(target.filter(|p| *p != position).map(|target| Pending { vertex, target }));
        }
        pending.sort_by_key(|pending| !self.is_corner(pending.vertex));
        pending
    }

    /// Moves vertices to their targets, and flips edges around them.
    fn move_all(
        &mut self,
        relocations: &[Relocation],
        pending: &mut Vec<Pending>,
        recovered: &mut Recovered,
    ) {
        // A move can be in the way of another one, and an edge in the way of either.
        for _ in 0..2 {
            let before = pending.len();
            pending.retain(|&Pending { vertex, target }| !self.patch.try_move(vertex, target));
            recovered.moved += (before - pending.len()) as u64;
            for relocation in relocations {
                recovered.flipped += self.flip_around(relocation.vertex);
            }
            if pending.is_empty() || pending.len() == before {
                break;
            }
        }
    }

    /// Relocates vertices by collapsing edges to neighbours that are in the way.
    fn relocate_by_collapse(&mut self, pending: &mut Vec<Pending>, recovered: &mut Recovered) {
        pending.retain(|pending| {
            let arrived = self.relocate_or_substitute(pending.vertex, pending.target);
            let Some((vertex, kind)) = arrived else { return true };
            recovered.moved += 1;
            recovered.merged += u64::from(kind == RelocationKind::Collapsed);
            if vertex != pending.vertex {
                recovered.merged += u64::from(self.remove_redundant(pending.vertex));
            }
            recovered.flipped += self.flip_around(vertex);
            false
        });
    }

    /// Moves a vertex that cannot have its target as near to it as it can come, or to another point
    /// of the surface, if that brings it closer to the surface.
    ///
    /// A vertex whose target is on the line between two others can nearly have it.
    fn move_part_way(&mut self, vertex: u32, target: [f64; 3]) {
        let Some(from) = self.patch.position(vertex) else { return };
        let (from, target) = (DVec3::from(from), DVec3::from(target));
        let error = self.error(from, &CreasePlanes::NONE);
        let near = SHARES.map(|share| Some(self.lattice.round(from + share * (target - from))));
        for to in near.into_iter().chain([self.surface_target(vertex)]).flatten() {
            if self.error(to.into(), &CreasePlanes::NONE) < error && self.patch.try_move(vertex, to) {
                return;
            }
        }
    }
}
