//! The schedule of patches: leaf by leaf, in eight rounds, by a colour of each leaf.
//!
//! Leaves of one colour are so far apart that they touch no common triangle. They are worked on in
//! parallel, and the result does not depend on the number of threads.

use super::patch::{Bounds, Patch};
use crate::band::LeafId;
use crate::contour::feature::MAX_FEATURE_REACH;
use crate::contour::mesh::{AXIS_STRIDE, CHANGED, Changes, LeafMesh, NEW_VERTEX};
use crate::contour::vertex::CellContext;
use crate::lattice::{Ijk, LEAF_DIM};
use crate::run::{Cancelled, RunSettings};
use rayon::prelude::*;

/// The reach of the triangles at the vertices of a leaf beyond the leaf, in voxels.
///
/// The other vertices of these triangles lie in the next cells, or up to [`MAX_FEATURE_REACH`]
/// outside of those. Two leaves with another one between them are 8 voxels apart, more than twice
/// this.
const LEAF_MARGIN: f64 = 1.0 + MAX_FEATURE_REACH;

const _: () =
    assert!(2.0 * LEAF_MARGIN < LEAF_DIM as f64, "leaves of one round must not touch the same triangles");

/// The width of a patch around the positions that its vertices leave and go to, in voxels.
///
/// That is the reach of the triangles of a vertex whose neighbours are in their cells, with a
/// little for neighbours that are not. Changes that need more are refused. With [`LEAF_MARGIN`]
/// four vertices of 1,460 more find room (armadillo +2% at 512), in patches of twice as many
/// triangles.
const PATCH_MARGIN: f64 = 2.25;

/// The farthest that a changed triangle may reach beyond its leaf, in voxels, whichever leaf
/// changes it.
///
/// The patch of a leaf is made of the triangles of this leaf and of its 26 neighbours. Triangles of
/// a leaf farther away must not reach into it.
pub const MAX_TRIANGLE_REACH: f64 = 4.0;

const _: () = assert!(MAX_TRIANGLE_REACH >= LEAF_MARGIN, "a leaf must be able to change its own triangles");
const _: () = assert!(
    MAX_TRIANGLE_REACH + LEAF_MARGIN < LEAF_DIM as f64,
    "a patch must hold all triangles in its bounds"
);

/// The most leaves in one rayon task. A patch takes a hundred times as long as a leaf in other
/// loops, and a round waits for the last one.
const MAX_TASK_LEN: usize = 1;

/// The width, in leaves, of the margin that is left as it is where the field is cut off: there the
/// mesh has a border.
pub const BORDER_LEAVES: i32 = 2;

/// Edits a mesh leaf by leaf, in parallel, with the same result for every number of threads.
///
/// For each of `leaves` for which `region` returns bounds, `edit` receives the patch of triangles
/// around them and returns it changed. The patch reaches as far beyond the bounds as a moved vertex
/// can pull its triangles. `collect` receives the results by colour, then by leaf.
///
/// # Errors
/// When the run is cancelled.
pub fn for_each_patch<T: Send>(
    mesh: &mut LeafMesh,
    context: &CellContext<'_>,
    leaves: impl Iterator<Item = LeafId>,
    run: &RunSettings,
    region: impl Fn(&LeafMesh, LeafId) -> Option<Bounds> + Sync,
    edit: impl Fn(LeafId, Patch) -> (Patch, T) + Sync,
    mut collect: impl FnMut(T),
) -> Result<(), Cancelled> {
    // The numbers of new vertices must stay free.
    if mesh.mesh.vertices.len() >= NEW_VERTEX as usize {
        return Ok(());
    }
    debug_assert!(triangles_are_near_leaves(mesh, context), "a triangle begins far from its leaf");
    let mut by_colour: [Vec<LeafId>; 8] = Default::default();
    for leaf in leaves.filter(|&leaf| context.signs.depth(leaf, BORDER_LEAVES) == BORDER_LEAVES) {
        by_colour[leaf_colour(context.signs.origin(leaf).0)].push(leaf);
    }
    for leaves in by_colour {
        let before = &*mesh;
        let changes: Vec<Option<(LeafId, Changes, T)>> = leaves
            .par_iter()
            .with_max_len(MAX_TASK_LEN)
            .map(|&leaf| {
                let Some(bounds) = region(before, leaf) else { return Ok(None) };
                run.check()?;
                let (patch, done) = edit(leaf, patch_around(before, context, leaf, &bounds));
                Ok(Some((leaf, patch.changes, done)))
            })
            .collect::<Result<_, Cancelled>>()?;
        for (leaf, changes, done) in changes.into_iter().flatten() {
            mesh.apply(leaf, changes);
            collect(done);
        }
    }
    debug_assert!(triangles_are_near_leaves(mesh, context), "a triangle strayed from its leaf");
    Ok(())
}

/// Makes the patch around the positions in `region`.
fn patch_around(mesh: &LeafMesh, context: &CellContext<'_>, leaf: LeafId, region: &Bounds) -> Patch {
    let signs = context.signs;
    let voxel = context.lattice.voxel();
    let bounds = region.grown(PATCH_MARGIN * voxel).within(&around_leaf(context, leaf, LEAF_MARGIN));
    let origin = signs.origin(leaf);
    let delta = |n: i32| [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
    let homes = std::array::from_fn(|n| {
        around(origin + Ijk(delta(n as i32).map(|d| LEAF_DIM * d)), voxel, MAX_TRIANGLE_REACH)
    });
    let mut patch = Patch::new(bounds, homes);
    let (mut found, mut corners) = (Vec::new(), Vec::new());
    for (home, around) in homes.iter().enumerate() {
        let Some(leaf) = signs.neighbour(leaf, delta(home as i32)) else { continue };
        if !around.meets(&bounds) {
            continue;
        }
        let nodes = NodesNear::new(signs.origin(leaf), voxel, &bounds);
        found.clear();
        find_triangles(mesh, leaf, &nodes, &mut found);
        debug_assert!(
            mesh.triangles(leaf)
                .all(|n| found.contains(&n) || !Bounds::around(mesh.corners(n)).meets(&bounds)),
            "a triangle left its grid edge and was missed"
        );
        // All corners before any of them is looked at: they come from far in memory, side by side
        // that way.
        corners.resize(found.len(), [[0.0; 3]; 3]);
        for (corners, &n) in corners.iter_mut().zip(&found) {
            for (corner, vertex) in corners.iter_mut().zip(mesh.mesh.triangles[n]) {
                *corner = mesh.mesh.vertices[vertex as usize];
            }
        }
        for (&number, corners) in found.iter().zip(&corners) {
            patch.add(number, &mesh.mesh.triangles[number], corners, home as u8);
        }
    }
    patch
}

/// Adds the numbers of the triangles of a leaf that may lie around one of `nodes` to `found`.
fn find_triangles(mesh: &LeafMesh, leaf: LeafId, nodes: &NodesNear, found: &mut Vec<usize>) {
    let n = leaf.0 as usize;
    if !nodes.are_none() {
        let first = mesh.firsts[n];
        let own = &mesh.edges[first..mesh.firsts[n + 1]];
        let mut rest = 0;
        for axis in 0..3 {
            let before = |end: u16| own[rest..].partition_point(|&e| e & !CHANGED < AXIS_STRIDE * axis + end);
            let (from, to) = (rest + before(nodes.first), rest + before(nodes.end));
            found.extend((from..to).filter(|&t| nodes.may_have(own[t])).map(|t| first + t));
            rest = to;
        }
    }
    found.extend(mesh.changed_or_added(leaf));
}

/// Whether every triangle is as near to its leaf as patches take it to be.
fn triangles_are_near_leaves(mesh: &LeafMesh, context: &CellContext<'_>) -> bool {
    context.signs.leaves().all(|leaf| {
        let home = around_leaf(context, leaf, MAX_TRIANGLE_REACH);
        mesh.triangles(leaf).all(|n| home.contains(&Bounds::around(mesh.corners(n))))
    })
}

/// The nodes of a leaf whose grid edges may have triangles in a box.
///
/// Looking at a node is far cheaper than at the corners of its triangles, which lie anywhere in
/// memory.
struct NodesNear {
    /// The first node of the first x layer in question.
    first: u16,
    /// The first node of the first x layer beyond.
    end: u16,
    /// A bit for each y and z that is in question.
    yz: u64,
}

impl NodesNear {
    /// Finds the nodes of the leaf at `origin` for a box.
    fn new(origin: Ijk, voxel: f64, bounds: &Bounds) -> NodesNear {
        // The triangles around an edge lie in the cells around it: within a voxel of its lower node
        // along each axis, but for the rounding of coordinates, an eighth of a voxel at most.
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

    /// Whether unchanged triangles of an edge, whose x is in question, may be in the box.
    #[inline]
    fn may_have(&self, edge: u16) -> bool {
        edge & CHANGED == 0 && self.yz >> (edge & 63) & 1 == 1
    }
}

/// Returns the box of a leaf with `margin` voxels around it.
fn around_leaf(context: &CellContext<'_>, leaf: LeafId, margin: f64) -> Bounds {
    around(context.signs.origin(leaf), context.lattice.voxel(), margin)
}

/// Returns the box of the leaf at `origin` with `margin` voxels around it.
fn around(origin: Ijk, voxel: f64, margin: f64) -> Bounds {
    let lo = origin.0.map(|x| voxel * f64::from(x));
    Bounds { lo, hi: lo.map(|x| x + voxel * f64::from(LEAF_DIM)) }.grown(margin * voxel)
}

/// Returns the colour of the leaf at `origin`, 0 to 7. Leaves of one colour have another leaf
/// between them along some axis.
fn leaf_colour(origin: [i32; 3]) -> usize {
    let [x, y, z] = origin.map(|x| (x.div_euclid(LEAF_DIM) & 1) as usize);
    4 * x + 2 * y + z
}
