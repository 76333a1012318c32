//! A finished mesh changed leaf by leaf: leaves that are far enough apart not to touch the same triangles are worked
//! on together, in eight rounds, so that the result does not depend on the number of threads.

use super::cells::Cells;
use super::feature::REACH;
use super::patch::{Bounds, Changes, NEW_TRIANGLE, NEW_VERTEX, Patch, PatchTriangle};
use crate::band::{LEAF_DIM, LeafId};
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use rayon::prelude::*;

type Point = [f64; 3];

/// How far the triangles at the vertices of a leaf reach beyond it, in voxels: their other vertices lie in the
/// next cells or up to REACH outside of those. Two leaves with another one between them are 8 voxels apart, more
/// than twice this.
const MARGIN: f64 = 1.0 + REACH;

const _: () =
    assert!(2.0 * MARGIN < LEAF_DIM as f64, "leaves of one round must not touch the same triangles");

/// A mesh whose triangles are known by leaf.
#[derive(Debug)]
pub struct LeafMesh {
    /// The mesh.
    pub mesh: TriMesh,
    /// The number of the first triangle of each leaf, and the number of all at the end.
    pub ranges: Vec<usize>,
    /// Triangles that were added later, by leaf.
    pub added: Vec<Vec<usize>>,
}

impl LeafMesh {
    /// The numbers of the triangles of a leaf.
    pub fn triangles(&self, leaf: LeafId) -> impl Iterator<Item = usize> + '_ {
        let n = leaf.0 as usize;
        (self.ranges[n]..self.ranges[n + 1]).chain(self.added[n].iter().copied())
    }

    /// Has `work` change the patches around the leaves that `places` gives points for, each by itself. The patch of
    /// a leaf reaches as far from the points as a vertex that is moved can pull its triangles. What `work` returns
    /// is handed to `sum`, by leaf.
    ///
    /// # Errors
    /// When the run is cancelled.
    pub fn in_rounds<T: Send>(
        &mut self,
        cells: &Cells<'_>,
        run: &RunSettings,
        places: impl Fn(&LeafMesh, LeafId) -> Option<Bounds> + Sync,
        work: impl Fn(LeafId, Patch) -> (Patch, T) + Sync,
        mut sum: impl FnMut(T),
    ) -> Result<(), Cancelled> {
        // The numbers of new vertices must stay free.
        if self.mesh.vertices.len() >= NEW_VERTEX as usize {
            return Ok(());
        }
        let mut by_colour: [Vec<LeafId>; 8] = Default::default();
        for leaf in cells.signs.leaves() {
            by_colour[colour(cells.signs.origin(leaf).0)].push(leaf);
        }
        for leaves in by_colour {
            let this = &*self;
            let changes: Vec<Option<(LeafId, Changes, T)>> = leaves
                .par_iter()
                .map(|&leaf| {
                    let Some(places) = places(this, leaf) else { return Ok(None) };
                    run.check()?;
                    let (patch, done) = work(leaf, this.patch(cells, leaf, &places));
                    Ok(Some((leaf, patch.changes, done)))
                })
                .collect::<Result<_, Cancelled>>()?;
            for (leaf, changes, done) in changes.into_iter().flatten() {
                self.apply(leaf, changes);
                sum(done);
            }
        }
        Ok(())
    }

    /// The triangles around `places`, as far as those of the leaf's vertices reach.
    fn patch(&self, cells: &Cells<'_>, leaf: LeafId, places: &Bounds) -> Patch {
        let voxel = cells.grid.voxel();
        let margin = MARGIN * voxel;
        let of_leaf = |leaf: LeafId| {
            let origin = cells.signs.origin(leaf).0.map(|x| voxel * f64::from(x));
            Bounds { lo: origin, hi: origin.map(|x| x + voxel * f64::from(LEAF_DIM)) }.grown(margin)
        };
        let bounds = places.grown(margin).within(&of_leaf(leaf));
        let around = (0..27)
            .filter_map(|n| cells.signs.neighbour(leaf, [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1]))
            .filter(|&leaf| of_leaf(leaf).meets(&bounds));
        let numbers = around.flat_map(|leaf| self.triangles(leaf));
        Patch::new(
            bounds,
            numbers.map(|number| PatchTriangle {
                number,
                vertices: self.mesh.triangles[number],
                corners: self.mesh.corners(number),
            }),
        )
    }

    /// Puts what a patch changed into the mesh.
    fn apply(&mut self, leaf: LeafId, changes: Changes) {
        let mesh = &mut self.mesh;
        let (first_vertex, first_triangle) = (mesh.vertices.len(), mesh.triangles.len());
        mesh.vertices.resize(first_vertex + changes.new_vertices as usize, [0.0; 3]);
        mesh.triangles.resize(first_triangle + changes.new_triangles, [0; 3]);
        self.added[leaf.0 as usize].extend(first_triangle..mesh.triangles.len());
        let vertex = |v: u32| v.checked_sub(NEW_VERTEX).map_or(v, |n| first_vertex as u32 + n);
        let triangle = |t: usize| t.checked_sub(NEW_TRIANGLE).map_or(t, |n| first_triangle + n);
        for (number, position) in changes.moved {
            mesh.vertices[vertex(number) as usize] = position;
        }
        for (number, vertices) in changes.triangles {
            mesh.triangles[triangle(number)] = vertices.map(vertex);
        }
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point; 3] {
        self.mesh.corners(triangle)
    }
}

/// Leaves of one colour have another leaf between them along some axis.
fn colour(origin: [i32; 3]) -> usize {
    let [x, y, z] = origin.map(|x| (x.div_euclid(LEAF_DIM) & 1) as usize);
    4 * x + 2 * y + z
}
