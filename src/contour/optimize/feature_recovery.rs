//! Creases and corners that lie outside the cells that see them.
//!
//! The construction keeps every vertex in its cell, and blunts features there that pass beside it: the tip of
//! a wedge that is thinner than a voxel, a corner between the nodes. When the mesh is finished, such vertices are
//! moved to where they belong, neighbours that are in the way there are merged into them, edges are flipped along the
//! crease, and what is far from the surface all the same is split, each only if the mesh stays embedded (see `patch`).
//!
//! First all vertices go to their places, then the rest is mended: a split that is made before the vertices around
//! it are in place is in their way later.

use super::collapse::Arrival;
use super::optimizer::{Editor, mix};
use super::patch::Bounds;
use super::schedule::for_each_patch;
use crate::contour::feature::Sides;
use crate::contour::implicit_surface::Surface;
use crate::contour::mesh::LeafMesh;
use crate::contour::vertex::{Cells, Relocation};
use crate::run::{Cancelled, RunSettings};

type Point = [f64; 3];

/// Around features, triangles and edges that are farther from the surface than this, in voxels, are split.
const TOLERANCE: f64 = 0.03;

/// Splits for each cell of a leaf, at most, in one pass. Models with a crease in every cell take 1.2 (armadillo at 64 voxels);
/// where more are asked for, the surface has its features at a scale that the lattice does not, and has no end of them.
const SPLITS_PER_CELL: usize = 4;

/// Shares of the way to its place that a vertex goes if it cannot go all of it.
const SHARES: [f64; 4] = [0.98, 0.9, 0.75, 0.5];

/// What became of the wishes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recovered {
    /// Vertices moved to where they belong.
    pub moved: u64,
    /// Vertices that got half-way only, or stayed.
    pub refused: u64,
    /// Vertices that went because they were in the way.
    pub merged: u64,
    /// Edges flipped.
    pub flipped: u64,
    /// Triangles and edges split.
    pub split: u64,
    /// Vertices around which splits ended at a limit, and the surface is still far.
    pub given_up: u64,
}

/// What is done in one pass over the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Vertices go to their places.
    Grant,
    /// What is still far from the surface is mended.
    Mend,
}

/// A leaf that is far from a neighbour's changes in one pass can be beside them in the next, so what is left is mended
/// once more. A third time would gain a tenth of that.
pub const STAGES: [Stage; 3] = [Stage::Grant, Stage::Mend, Stage::Mend];

/// Moves vertices of the finished mesh to where they belong. `wishes` has a list for each leaf.
///
/// # Errors
/// When the run is cancelled.
pub fn recover(
    cells: &Cells<'_>,
    surface: &dyn Surface,
    wishes: &[Vec<Relocation>],
    mesh: &mut LeafMesh,
    run: &RunSettings,
) -> Result<Recovered, Cancelled> {
    let mut recovered = Recovered::default();
    // By leaf how many wishes are not granted, and whether there is something left to do.
    let mut open: Vec<(u64, bool)> = wishes.iter().map(|w| (0, !w.is_empty())).collect();
    for stage in STAGES {
        let mut next = open.clone();
        for_each_patch(
            mesh,
            &cells.context,
            cells.context.signs.leaves().filter(|leaf| open[leaf.0 as usize].1),
            run,
            |mesh, leaf| {
                let places =
                    |w: &Relocation| w.target.into_iter().chain([mesh.mesh.vertices[w.vertex as usize]]);
                Some(Bounds::around(wishes[leaf.0 as usize].iter().flat_map(places)))
            },
            |leaf, patch| {
                let mut editor = Editor::new(patch, surface, cells, TOLERANCE, true);
                editor.splits_left = (SPLITS_PER_CELL * cells.context.numbers.range(leaf).len()) as u64;
                let done = editor.grant_all(&wishes[leaf.0 as usize], stage);
                (editor.patch, (leaf, done))
            },
            |(leaf, (done, is_partial))| {
                next[leaf.0 as usize] = (done.refused, is_partial);
                if !cells.context.owns(leaf) {
                    return;
                }
                recovered.moved += done.moved;
                recovered.merged += done.merged;
                recovered.flipped += done.flipped;
                recovered.split += done.split;
                recovered.given_up += done.given_up;
            },
        )?;
        open = next;
    }
    let owned = cells.context.signs.leaves().zip(&open).filter(|(leaf, _)| cells.context.owns(*leaf));
    recovered.refused = owned.map(|(_, (refused, _))| refused).sum();
    Ok(recovered)
}

impl Editor<'_> {
    /// What was done, and whether something is left to do.
    fn grant_all(&mut self, wishes: &[Relocation], stage: Stage) -> (Recovered, bool) {
        let mut recovered = Recovered::default();
        let mut open = self.open(wishes);
        self.move_all(wishes, &mut open, &mut recovered);
        self.make_way(&mut open, &mut recovered);
        if stage == Stage::Mend {
            for (wish, place) in &open {
                self.console(wish.vertex, *place);
            }
            for wish in wishes {
                recovered.split += self.split_around(wish.vertex);
            }
            self.make_way(&mut open, &mut recovered);
            for wish in wishes {
                let merged = self.tidy_around(wish.vertex);
                if merged > 0 {
                    recovered.merged += merged;
                    recovered.flipped += self.flip_around(wish.vertex);
                }
            }
        }
        recovered.refused = open.len() as u64;
        recovered.given_up = self.given_up;
        let is_partial = !open.is_empty()
            || match stage {
                Stage::Grant => {
                    wishes.iter().any(|w| self.is_far_around(w.vertex) || self.is_untidy(w.vertex))
                }
                Stage::Mend => recovered.split > 0,
            };
        (recovered, is_partial)
    }

    /// The vertices that are not where they belong, corners first, since creases can go around them.
    fn open(&mut self, wishes: &[Relocation]) -> Vec<(Relocation, Point)> {
        let mut open: Vec<(Relocation, Point)> = Vec::with_capacity(wishes.len());
        for wish in wishes {
            let Some(position) = self.patch.position(wish.vertex) else { continue };
            let place = wish.target.or_else(|| self.place_on_surface(wish.vertex));
            open.extend(place.filter(|p| *p != position).map(|place| (*wish, place)));
        }
        open.sort_by_key(|(wish, _)| !self.is_corner(wish.vertex));
        open
    }

    /// Moves vertices, and flips edges around them.
    fn move_all(
        &mut self,
        wishes: &[Relocation],
        open: &mut Vec<(Relocation, Point)>,
        recovered: &mut Recovered,
    ) {
        // A move can be in the way of another one, and an edge in the way of either.
        for _ in 0..2 {
            let before = open.len();
            open.retain(|(wish, place)| !self.patch.try_move(wish.vertex, *place));
            recovered.moved += (before - open.len()) as u64;
            for wish in wishes {
                recovered.flipped += self.flip_around(wish.vertex);
            }
            if open.is_empty() || open.len() == before {
                break;
            }
        }
    }

    /// Brings vertices to their places by merging what is in the way there.
    fn make_way(&mut self, open: &mut Vec<(Relocation, Point)>, recovered: &mut Recovered) {
        open.retain(|(wish, place)| {
            let Some((vertex, arrival)) = self.reach(wish.vertex, *place) else { return true };
            recovered.moved += 1;
            recovered.merged += u64::from(arrival == Arrival::Merged);
            if vertex != wish.vertex {
                recovered.merged += u64::from(self.retire(wish.vertex));
            }
            recovered.flipped += self.flip_around(vertex);
            false
        });
    }

    /// The next best for a vertex that cannot have its place: as near to it as it can come, or some place on the
    /// surface. A vertex whose place is on the line between two others can nearly have it.
    fn console(&mut self, vertex: u32, place: Point) {
        let Some(from) = self.patch.position(vertex) else { return };
        let error = self.error(from, &Sides::NONE);
        let near = SHARES.map(|share| Some(self.lattice.round(mix(from, place, share))));
        for place in near.into_iter().chain([self.place_on_surface(vertex)]).flatten() {
            if self.error(place, &Sides::NONE) < error && self.patch.try_move(vertex, place) {
                return;
            }
        }
    }
}
