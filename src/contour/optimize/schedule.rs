//! A finished mesh changed leaf by leaf: leaves that are far enough apart not to touch the same triangles are worked
//! on together, in eight rounds, so that the result does not depend on the number of threads.

use super::patch::{Bounds, Patch};
use crate::band::LeafId;
use crate::contour::feature::REACH;
use crate::contour::mesh::{Changes, NEW_TRIANGLE, NEW_VERTEX, VertexRun};
use crate::contour::vertex::Cells;
use crate::lattice::{Ijk, LEAF_DIM};
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

/// How far around the places where vertices are and go to a patch reaches, in voxels: as far as the triangles of a vertex
/// whose neighbours are in their cells, with a little for those that are not. Changes that need more are refused; with
/// [`MARGIN`] four vertices of 1,460 more find room (armadillo +2% at 512), in patches of twice as many triangles.
const NEAR: f64 = 2.25;

/// How far a triangle may be changed to reach beyond the leaf that it belongs to, in voxels, by whichever leaf around
/// it. The patch of a leaf is made of the triangles of this leaf and of its 26 neighbours: those of a leaf further
/// away must not reach into it.
pub const STRAY: f64 = 4.0;

const _: () = assert!(STRAY >= MARGIN, "a leaf must be able to change its own triangles");
const _: () = assert!(STRAY + MARGIN < LEAF_DIM as f64, "a patch must hold all triangles in its bounds");

/// Leaves that a thread takes on at a time at most: a patch takes a hundred times as long as a leaf in other loops, and a
/// round waits for the last one.
const PATCHES: usize = 1;

/// Leaves that are left as they are where the field is cut off: there the mesh has a border.
pub const AT_CUT: i32 = 2;

/// A mesh whose triangles are known by leaf.
#[derive(Debug)]
pub struct LeafMesh {
    /// The mesh.
    pub mesh: TriMesh,
    /// The number of the first triangle of each leaf, and the number of all at the end.
    pub ranges: Vec<usize>,
    /// The grid edge that each triangle lies around: the number of its lower node in the leaf, and [`AXIS`] times its axis.
    /// They ascend within a leaf, but for [`CHANGED`], which those of changed triangles have.
    pub edges: Vec<u16>,
    /// Triangles that were changed, by leaf: they may no longer lie around their grid edge.
    pub changed: Vec<Vec<usize>>,
    /// Triangles that were added later, by leaf.
    pub added: Vec<Vec<usize>>,
    /// Which vertices belong to which leaf: each to one.
    pub runs: Vec<VertexRun>,
    /// The vertices that are gone, in the order in which they went.
    pub gone: Vec<u32>,
}

/// What the axis counts in the number of a grid edge: as much as the nodes of a leaf.
pub const AXIS: u16 = 512;

/// Marks the edge of a triangle that may no longer lie around it.
pub const CHANGED: u16 = 1 << 15;

/// The vertices of a triangle that is gone: patches are not made when vertices have numbers that large.
pub const GONE: [u32; 3] = [u32::MAX; 3];

impl LeafMesh {
    /// The numbers of the triangles of a leaf.
    pub fn triangles(&self, leaf: LeafId) -> impl Iterator<Item = usize> + '_ {
        self.numbers(leaf).filter(|&t| self.mesh.triangles[t] != GONE)
    }

    /// How many they are.
    pub fn count(&self, leaf: LeafId) -> usize {
        let n = leaf.0 as usize;
        // Only what was changed or added can be gone.
        let moved = self.changed[n].iter().chain(&self.added[n]);
        let gone = moved.filter(|&&t| self.mesh.triangles[t] == GONE).count();
        self.ranges[n + 1] - self.ranges[n] + self.added[n].len() - gone
    }

    /// The same, with those that are gone.
    #[inline]
    fn numbers(&self, leaf: LeafId) -> impl Iterator<Item = usize> + '_ {
        let n = leaf.0 as usize;
        (self.ranges[n]..self.ranges[n + 1]).chain(self.added[n].iter().copied())
    }

    /// Has `work` change the patches around those of `leaves` that `places` gives points for, each by itself. The patch of
    /// a leaf reaches as far from the points as a vertex that is moved can pull its triangles. What `work` returns
    /// is handed to `sum`, by leaf.
    ///
    /// # Errors
    /// When the run is cancelled.
    pub fn in_rounds<T: Send>(
        &mut self,
        cells: &Cells<'_>,
        leaves: impl Iterator<Item = LeafId>,
        run: &RunSettings,
        places: impl Fn(&LeafMesh, LeafId) -> Option<Bounds> + Sync,
        work: impl Fn(LeafId, Patch) -> (Patch, T) + Sync,
        mut sum: impl FnMut(T),
    ) -> Result<(), Cancelled> {
        // The numbers of new vertices must stay free.
        if self.mesh.vertices.len() >= NEW_VERTEX as usize {
            return Ok(());
        }
        debug_assert!(self.is_at_home(cells), "a triangle begins far from its leaf");
        let mut by_colour: [Vec<LeafId>; 8] = Default::default();
        for leaf in leaves.filter(|&leaf| cells.signs.depth(leaf, AT_CUT) == AT_CUT) {
            by_colour[colour(cells.signs.origin(leaf).0)].push(leaf);
        }
        for leaves in by_colour {
            let this = &*self;
            let changes: Vec<Option<(LeafId, Changes, T)>> = leaves
                .par_iter()
                .with_max_len(PATCHES)
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
        debug_assert!(self.is_at_home(cells), "a triangle strayed from its leaf");
        Ok(())
    }

    /// The triangles around `places`, as far as those of the leaf's vertices reach.
    fn patch(&self, cells: &Cells<'_>, leaf: LeafId, places: &Bounds) -> Patch {
        let voxel = cells.grid.voxel();
        let bounds = places.grown(NEAR * voxel).within(&around_leaf(cells, leaf, MARGIN));
        let origin = cells.signs.origin(leaf);
        let delta = |n: i32| [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
        let homes = std::array::from_fn(|n| {
            around(origin + Ijk(delta(n as i32).map(|d| LEAF_DIM * d)), voxel, STRAY)
        });
        let mut patch = Patch::new(bounds, homes);
        let (mut found, mut corners) = (Vec::new(), Vec::new());
        for (home, around) in homes.iter().enumerate() {
            let Some(leaf) = cells.signs.neighbour(leaf, delta(home as i32)) else { continue };
            if !around.meets(&bounds) {
                continue;
            }
            let nodes = NodesNear::new(cells.signs.origin(leaf), voxel, &bounds);
            found.clear();
            self.find(leaf, &nodes, &mut found);
            debug_assert!(
                self.triangles(leaf)
                    .all(|n| found.contains(&n) || !Bounds::around(self.corners(n)).meets(&bounds)),
                "a triangle left its grid edge unseen"
            );
            // All corners before any of them is looked at: they come from far in memory, side by side that way.
            corners.resize(found.len(), [[0.0; 3]; 3]);
            for (corners, &n) in corners.iter_mut().zip(&found) {
                for (corner, vertex) in corners.iter_mut().zip(self.mesh.triangles[n]) {
                    *corner = self.mesh.vertices[vertex as usize];
                }
            }
            for (&number, corners) in found.iter().zip(&corners) {
                patch.add(number, &self.mesh.triangles[number], corners, home as u8);
            }
        }
        patch
    }

    /// Adds the numbers of the triangles of a leaf that may be where `nodes` tells.
    fn find(&self, leaf: LeafId, nodes: &NodesNear, found: &mut Vec<usize>) {
        let n = leaf.0 as usize;
        if !nodes.are_none() {
            let first = self.ranges[n];
            let own = &self.edges[first..self.ranges[n + 1]];
            let mut rest = 0;
            for axis in 0..3 {
                let before = |end: u16| own[rest..].partition_point(|&e| e & !CHANGED < AXIS * axis + end);
                let (from, to) = (rest + before(nodes.first), rest + before(nodes.end));
                found.extend((from..to).filter(|&t| nodes.may_have(own[t])).map(|t| first + t));
                rest = to;
            }
        }
        let moved = self.changed[n].iter().chain(&self.added[n]);
        found.extend(moved.filter(|&&t| self.mesh.triangles[t] != GONE));
    }

    /// Whether every triangle is as near to its leaf as patches take it to be.
    fn is_at_home(&self, cells: &Cells<'_>) -> bool {
        cells.signs.leaves().all(|leaf| {
            let home = around_leaf(cells, leaf, STRAY);
            self.triangles(leaf).all(|n| home.contains(&Bounds::around(self.corners(n))))
        })
    }

    /// Puts what a patch changed into the mesh.
    pub fn apply(&mut self, leaf: LeafId, changes: Changes) {
        let mesh = &mut self.mesh;
        let (first_vertex, first_triangle) = (mesh.vertices.len(), mesh.triangles.len());
        mesh.vertices.resize(first_vertex + changes.new_vertices as usize, [0.0; 3]);
        mesh.triangles.resize(first_triangle + changes.new_triangles, [0; 3]);
        self.added[leaf.0 as usize].extend(first_triangle..mesh.triangles.len());
        if changes.new_vertices > 0 {
            self.runs.push(VertexRun { leaf, numbers: first_vertex as u32..mesh.vertices.len() as u32 });
        }
        let vertex = |v: u32| v.checked_sub(NEW_VERTEX).map_or(v, |n| first_vertex as u32 + n);
        let triangle = |t: usize| t.checked_sub(NEW_TRIANGLE).map_or(t, |n| first_triangle + n);
        for (number, position) in changes.moved {
            mesh.vertices[vertex(number) as usize] = position;
        }
        for (number, vertices) in changes.triangles {
            let number = triangle(number);
            mesh.triangles[number] = vertices.map_or(GONE, |v| v.map(vertex));
            // Added ones have no edge.
            if let Some(edge) = self.edges.get_mut(number).filter(|edge| **edge & CHANGED == 0) {
                *edge |= CHANGED;
                let leaf = self.ranges.partition_point(|&first| first <= number) - 1;
                self.changed[leaf].push(number);
            }
        }
        self.gone.extend(changes.gone_vertices.into_iter().map(vertex));
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Point; 3] {
        self.mesh.corners(triangle)
    }
}

/// The nodes of a leaf whose grid edges may have triangles in a box. Looking at a node is far cheaper than at the corners
/// of its triangles, which lie anywhere in memory.
struct NodesNear {
    /// The first node that is in question: the first of those with its x.
    first: u16,
    /// The first one beyond, likewise.
    end: u16,
    /// A bit for each y and z that is in question.
    yz: u64,
}

impl NodesNear {
    /// Of the leaf at `origin`.
    fn new(origin: Ijk, voxel: f64, bounds: &Bounds) -> NodesNear {
        // The triangles around an edge lie in the cells around it: within a voxel of its lower node along each axis, but
        // for the rounding of coordinates, an eighth of a voxel at most.
        const WITHIN: f64 = 1.25;
        let [x, y, z] = std::array::from_fn(|a| {
            let local = |x: f64| x / voxel - f64::from(origin.0[a]);
            let low = (local(bounds.lo[a]) - WITHIN).ceil().max(0.0) as i32;
            let high = (local(bounds.hi[a]) + WITHIN).floor().min(f64::from(LEAF_DIM - 1)) as i32;
            low..high + 1
        });
        let yz =
            y.flat_map(|y| z.clone().map(move |z| 1u64 << (LEAF_DIM * y + z))).fold(0, |all, bit| all | bit);
        let plane = |x: i32| (x.clamp(0, LEAF_DIM) * LEAF_DIM * LEAF_DIM) as u16;
        NodesNear { first: plane(x.start), end: plane(x.end), yz }
    }

    /// Whether no node is in question.
    fn are_none(&self) -> bool {
        self.first >= self.end || self.yz == 0
    }

    /// Whether triangles of this edge, whose x is in question, may be there and are where they were made.
    #[inline]
    fn may_have(&self, edge: u16) -> bool {
        edge & CHANGED == 0 && self.yz >> (edge & 63) & 1 == 1
    }
}

/// A leaf with `reach` voxels around it.
fn around_leaf(cells: &Cells<'_>, leaf: LeafId, reach: f64) -> Bounds {
    around(cells.signs.origin(leaf), cells.grid.voxel(), reach)
}

/// The leaf at `origin` with `reach` voxels around it.
fn around(origin: Ijk, voxel: f64, reach: f64) -> Bounds {
    let lo = origin.0.map(|x| voxel * f64::from(x));
    Bounds { lo, hi: lo.map(|x| x + voxel * f64::from(LEAF_DIM)) }.grown(reach * voxel)
}

/// Leaves of one colour have another leaf between them along some axis.
fn colour(origin: [i32; 3]) -> usize {
    let [x, y, z] = origin.map(|x| (x.div_euclid(LEAF_DIM) & 1) as usize);
    4 * x + 2 * y + z
}
