//! The exact tests of what was not made by the contour alone.

use super::unsuitable::{Blocked, Obstacle, PatchError};
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::verify::boxes::BoxTree;
use rayon::prelude::*;

/// Checks that the patch, as it will be written, has area everywhere and does not intersect itself.
pub(super) fn check_patch(patch: &TriMesh, run: &RunSettings) -> Result<Result<(), PatchError>, Cancelled> {
    let is_flat = |t: &usize| projection_axis(patch.corners(*t)).is_none();
    if let Some(t) = (0..patch.triangles.len()).into_par_iter().find_first(is_flat) {
        return Ok(Err(PatchError::Degenerate { triangle: t as u32, at: patch.corners(t)[0] }));
    }
    let tree = BoxTree::new(patch, (0..patch.triangles.len() as u32).into_par_iter());
    let found = first_pair(patch, &tree, |_, _| true, run)?;
    Ok(found.map_or(Ok(()), |(triangles, at)| Err(PatchError::Intersects { triangles, at })))
}

/// Checks that none of the first `patch` triangles meets a later one.
pub(super) fn check_apart(
    mesh: &TriMesh,
    tree: &BoxTree,
    patch: u32,
    run: &RunSettings,
) -> Result<Result<(), Blocked>, Cancelled> {
    let found = first_pair(mesh, tree, |a, b| (a < patch) != (b < patch), run)?;
    Ok(found.map_or(Ok(()), |(_, at)| Err(Blocked { obstacle: Obstacle::Shell, at })))
}

/// The first pair, by number, of triangles that meet, of those that `wanted` wants.
fn first_pair(
    mesh: &TriMesh,
    tree: &BoxTree,
    wanted: impl Fn(u32, u32) -> bool + Sync,
    run: &RunSettings,
) -> Result<Option<([u32; 2], [f64; 3])>, Cancelled> {
    type Found = Option<([u32; 2], [f64; 3])>;
    let tasks = tree.pairs(
        run,
        || None,
        |found: &mut Found, a, b| {
            if !wanted(a, b) || found.is_some_and(|(pair, _)| pair < [a, b]) {
                return;
            }
            let (va, vb) = (mesh.triangles[a as usize], mesh.triangles[b as usize]);
            if let Some(at) = meeting_point(va, mesh.corners(a as usize), vb, mesh.corners(b as usize)) {
                *found = Some(([a, b], at));
            }
        },
    )?;
    Ok(tasks.into_iter().flatten().min_by_key(|(pair, _)| *pair))
}
