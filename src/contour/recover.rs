//! Creases and corners that lie outside the cells that see them.
//!
//! The construction keeps every vertex in its cell, and blunts features there that pass beside it: the tip of
//! a wedge that is thinner than a voxel, a corner between the nodes. When the mesh is finished, such vertices are
//! moved to where they belong, edges are flipped along the crease, and what is far from the surface all the same is
//! split, each only if the mesh stays embedded (see `patch`).

use super::cells::Cells;
use super::editor::Editor;
use super::features::Sides;
use super::patch::Bounds;
use super::rounds::LeafMesh;
use super::surface::Surface;
use crate::run::{Cancelled, RunSettings};

type Point = [f64; 3];

/// Around features, triangles and edges that are farther from the surface than this, in voxels, are split.
const TOLERANCE: f64 = 0.03;

/// Shares of the way to its place that a vertex goes if it cannot go all of it.
const SHARES: [f64; 4] = [0.98, 0.9, 0.75, 0.5];

/// Where a vertex ought to be.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// The vertex.
    pub vertex: u32,
    /// Its own place, rounded; `None` when the surface is far there or around it.
    pub place: Option<Point>,
}

/// What became of the wishes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Recovered {
    /// Vertices moved to where they belong.
    pub moved: u64,
    /// Vertices that got half-way only, or stayed.
    pub refused: u64,
    /// Edges flipped.
    pub flipped: u64,
    /// Triangles and edges split.
    pub split: u64,
}

/// Moves vertices of the finished mesh to where they belong. `wishes` has a list for each leaf.
///
/// # Errors
/// When the run is cancelled.
pub fn recover(
    cells: &Cells<'_>,
    surface: &dyn Surface,
    wishes: &[Vec<Wish>],
    mesh: &mut LeafMesh,
    run: &RunSettings,
) -> Result<Recovered, Cancelled> {
    let mut recovered = Recovered::default();
    let (grid, features) = (&cells.grid, &cells.features);
    mesh.in_rounds(
        cells,
        run,
        |mesh, leaf| {
            let wishes = &wishes[leaf.0 as usize];
            let places = |w: &Wish| w.place.into_iter().chain([mesh.mesh.vertices[w.vertex as usize]]);
            (!wishes.is_empty()).then(|| Bounds::around(wishes.iter().flat_map(places)))
        },
        |leaf, patch| {
            let tolerance = TOLERANCE;
            let mut editor = Editor { patch, surface, grid, features, tolerance, trusting: true, hint: 0 };
            let done = editor.grant_all(&wishes[leaf.0 as usize]);
            (editor.patch, done)
        },
        |done| {
            recovered.moved += done.moved;
            recovered.refused += done.refused;
            recovered.flipped += done.flipped;
            recovered.split += done.split;
        },
    )?;
    Ok(recovered)
}

impl Editor<'_> {
    fn grant_all(&mut self, wishes: &[Wish]) -> Recovered {
        let mut recovered = Recovered::default();
        let mut open: Vec<(Wish, Point)> = Vec::with_capacity(wishes.len());
        for wish in wishes {
            let place = wish.place.or_else(|| self.place_on_surface(wish.vertex));
            open.extend(place.map(|place| (*wish, place)));
        }
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
        for (wish, place) in &open {
            self.console(wish.vertex, *place);
        }
        recovered.refused = open.len() as u64;
        for wish in wishes {
            recovered.split += self.split_around(wish.vertex);
        }
        recovered
    }

    /// The next best for a vertex that cannot have its place: as near to it as it can come, or some place on the
    /// surface. A vertex whose place is on the line between two others can nearly have it.
    fn console(&mut self, vertex: u32, place: Point) {
        let Some(from) = self.patch.position(vertex) else { return };
        let error = self.error(from, &Sides::NONE);
        let near = SHARES.map(|share| Some(self.grid.round(mix(from, place, share))));
        for place in near.into_iter().chain([self.place_on_surface(vertex)]).flatten() {
            if self.error(place, &Sides::NONE) < error && self.patch.try_move(vertex, place) {
                return;
            }
        }
    }
}

fn mix(a: Point, b: Point, share: f64) -> Point {
    std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
}
