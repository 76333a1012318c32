//! The mesh refined until it is within a tolerance of the surface.
//!
//! Triangles are looked at in the middle, in the middles of their edges and at their vertices.
//! Where a triangle is too far from the surface, it is split at the worst point, with a new vertex
//! on the surface or on its crease, as often as it takes. Each edit is made only if the mesh stays
//! embedded (see `patch`).

use super::optimizer::{ErrorSource, PatchOptimizer};
use super::patch::Bounds;
use super::schedule::for_each_patch;
use crate::band::LeafId;
use crate::contour::implicit_surface::ImplicitSurface;
use crate::contour::mesh::LeafMesh;
use crate::contour::vertex::Cells;
use crate::run::{Cancelled, RunSettings};

/// The most passes that split.
///
/// Each halves the edges that are too far, so that the error of smooth parts shrinks to a quarter:
/// to 1/256 in all. More passes would let a tolerance that is too small multiply the mesh without
/// end.
const SPLIT_PASSES: u32 = 4;

/// The number of all passes, with the one that only counts.
pub const TOLERANCE_PASSES: usize = SPLIT_PASSES as usize + 1;

/// The share of the tolerance that the points that are looked at must meet. Between them the error
/// can be larger.
const TOLERANCE_SHARE: f64 = 0.8;

/// Counts of a refinement.
#[derive(Clone, Copy, Debug, Default)]
pub struct Refined {
    /// Vertices added.
    pub split: u64,
    /// Vertices moved onto the surface.
    pub moved: u64,
    /// Triangles that are still farther from the surface than the tolerance.
    pub beyond: u64,
}

/// Refines the mesh until no triangle is farther from the surface than `tolerance`, in voxels, or
/// nothing changes.
///
/// # Errors
/// When the run is cancelled.
pub fn refine(
    cells: &Cells<'_>,
    surface: &dyn ImplicitSurface,
    tolerance: f64,
    mesh: &mut LeafMesh,
    run: &RunSettings,
) -> Result<Refined, Cancelled> {
    let context = &cells.context;
    let mut refined = Refined::default();
    let mut is_last = false;
    for pass in 0..=SPLIT_PASSES {
        // The last pass only looks.
        is_last |= pass == SPLIT_PASSES;
        let tolerance = if is_last { tolerance } else { TOLERANCE_SHARE * tolerance };
        let numbers: Vec<Vec<usize>> =
            context.signs.leaves().map(|leaf| mesh.triangles(leaf).collect()).collect();
        let mut done = Refined::default();
        let mut changed = false;
        for_each_patch(
            mesh,
            context,
            context.signs.leaves(),
            run,
            |mesh, leaf| {
                mesh.triangles(leaf).next()?;
                Some(Bounds::around(mesh.triangles(leaf).flat_map(|t| mesh.corners(t))))
            },
            |leaf, patch| {
                let source = ErrorSource::Surface;
                let mut optimizer = PatchOptimizer::new(patch, surface, cells, tolerance, source);
                let numbers = &numbers[leaf.0 as usize];
                let done = if is_last { optimizer.count_beyond(numbers) } else { optimizer.refine(numbers) };
                (optimizer.patch, (leaf, done))
            },
            |(leaf, of_leaf): (LeafId, Refined)| {
                changed |= of_leaf.split + of_leaf.moved > 0;
                if !context.owns(leaf) {
                    return;
                }
                done.split += of_leaf.split;
                done.moved += of_leaf.moved;
                done.beyond += of_leaf.beyond;
            },
        )?;
        refined = Refined { split: refined.split + done.split, moved: refined.moved + done.moved, ..done };
        if is_last {
            break;
        }
        is_last = !changed;
    }
    Ok(refined)
}

impl PatchOptimizer<'_> {
    /// Counts the triangles with the given numbers of the mesh that are too far from the surface.
    fn count_beyond(&mut self, numbers: &[usize]) -> Refined {
        let own = self.patch.numbered(numbers);
        let beyond = own.into_iter().filter(|&n| self.is_beyond(n)).count() as u64;
        Refined { beyond, ..Refined::default() }
    }

    /// Moves the vertices of the triangles with the given numbers of the mesh to the surface, and
    /// splits the triangles once, where they are too far from it.
    fn refine(&mut self, numbers: &[usize]) -> Refined {
        let mut refined = Refined::default();
        let own = self.patch.numbered(numbers);
        let mut vertices: Vec<u32> = own.iter().flat_map(|&n| self.patch.triangle_at(n).vertices).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let jumps = self.jumps;
        for vertex in vertices.into_iter().filter(|&vertex| !jumps.contains(vertex)) {
            if let Some(target) = self.surface_target(vertex) {
                refined.moved += u64::from(self.patch.try_move(vertex, target));
            }
        }
        for n in own {
            if self.patch.is_gone(n) {
                continue;
            }
            let Some(worst) = self.worst(n) else { continue };
            if let Some(new) = self.improve(n, worst) {
                refined.split += 1;
                self.flip_around(new);
            }
        }
        refined
    }
}
