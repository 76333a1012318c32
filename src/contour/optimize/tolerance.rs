//! The mesh refined until it is within a tolerance of the surface, where it is not.
//!
//! Triangles are looked at in the middle, in the middles of their sides and at their corners. What is too far there is
//! split at the worst place, with a new vertex on the surface or on its crease, as often as it takes; each change is
//! made only if the mesh stays embedded (see `patch`).

use super::optimizer::Editor;
use super::patch::Bounds;
use super::schedule::for_each_patch;
use crate::band::LeafId;
use crate::contour::implicit_surface::Surface;
use crate::contour::mesh::LeafMesh;
use crate::contour::vertex::Cells;
use crate::run::{Cancelled, RunSettings};

/// Passes over the mesh. Each halves the edges that are too far, so that the error of smooth parts shrinks to a
/// quarter: to 1/256 in all. More passes would let a tolerance that is too small multiply the mesh without end.
const PASSES: u32 = 4;

/// All passes, with the one that only counts.
pub const STAGES: usize = PASSES as usize + 1;

/// Between the places that are looked at the error can be larger than there: they must meet this share of the
/// tolerance.
const SHARE: f64 = 0.8;

/// What refining did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Refined {
    /// Vertices added.
    pub split: u64,
    /// Vertices moved onto the surface.
    pub moved: u64,
    /// Triangles that are still farther from the surface than the tolerance.
    pub beyond: u64,
}

/// Refines the mesh until no triangle is farther from the surface than `tolerance`, in voxels, or nothing changes.
///
/// # Errors
/// When the run is cancelled.
pub fn refine(
    cells: &Cells<'_>,
    surface: &dyn Surface,
    tolerance: f64,
    mesh: &mut LeafMesh,
    run: &RunSettings,
) -> Result<Refined, Cancelled> {
    let mut refined = Refined::default();
    let mut is_last = false;
    for pass in 0..=PASSES {
        // The last pass only looks.
        is_last |= pass == PASSES;
        let tolerance = if is_last { tolerance } else { SHARE * tolerance };
        let numbers: Vec<Vec<usize>> =
            cells.context.signs.leaves().map(|leaf| mesh.triangles(leaf).collect()).collect();
        let mut done = Refined::default();
        let mut changed = false;
        for_each_patch(
            mesh,
            &cells.context,
            cells.context.signs.leaves(),
            run,
            |mesh, leaf| {
                mesh.triangles(leaf).next()?;
                Some(Bounds::around(mesh.triangles(leaf).flat_map(|t| mesh.corners(t))))
            },
            |leaf, patch| {
                let mut editor = Editor::new(patch, surface, cells, tolerance, false);
                let done = editor.refine(&numbers[leaf.0 as usize], is_last);
                (editor.patch, (leaf, done))
            },
            |(leaf, of_leaf): (LeafId, Refined)| {
                changed |= of_leaf.split + of_leaf.moved > 0;
                if !cells.context.owns(leaf) {
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

impl Editor<'_> {
    /// Splits the triangles with the given numbers of the mesh once, where they are too far from the surface, and
    /// moves their corners there; or only counts them.
    fn refine(&mut self, numbers: &[usize], only_count: bool) -> Refined {
        let mut refined = Refined::default();
        let own = self.patch.numbered(numbers);
        if only_count {
            refined.beyond = own.iter().filter(|&&n| self.is_beyond(n)).count() as u64;
            return refined;
        }
        let mut corners: Vec<u32> = own.iter().flat_map(|&n| self.patch.triangle_at(n).vertices).collect();
        corners.sort_unstable();
        corners.dedup();
        let jumps = self.jumps;
        for vertex in corners.into_iter().filter(|&vertex| !jumps.contains(vertex)) {
            if let Some(place) = self.place_on_surface(vertex) {
                refined.moved += u64::from(self.patch.try_move(vertex, place));
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
