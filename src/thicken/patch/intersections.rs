//! Exact tests of what the contour alone did not make.

use crate::geom::box_tree::BoxTree;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use crate::thicken::{PatchError, ThickenError};
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Checks that the patch, as it will be written, has area everywhere and does not intersect itself.
///
/// # Errors
/// [`ThickenError::Patch`] with the first fault, or [`ThickenError::Cancelled`].
pub(crate) fn check_patch(patch: &TriMesh, run: &RunSettings) -> Result<(), ThickenError> {
    let is_flat = |t: &usize| projection_axis(patch.corners(*t)).is_none();
    if let Some(t) = (0..patch.triangles.len()).into_par_iter().find_first(is_flat) {
        return Err(PatchError::Degenerate { triangle: t as u32, at: patch.corners(t)[0] }.into());
    }
    let tree =
        BoxTree::new(&patch.vertices, &patch.triangles, (0..patch.triangles.len() as u32).into_par_iter());
    match first_pair(patch, &tree, run)? {
        Some((triangles, at)) => Err(PatchError::Intersects { triangles, at }.into()),
        None => Ok(()),
    }
}

/// Least number of triangles, for each triangle of the patch, at which each triangle of the patch
/// is looked up by itself. With fewer, all pairs are gone through, which takes a few times as long
/// as looking up one in eight.
const TRIANGLES_PER_LOOKUP: usize = 8;

/// Finds the triangles from number `patch` on that meet one before, each with a point of both.
pub(crate) fn meeting_patch(
    mesh: &TriMesh,
    tree: &BoxTree,
    patch: u32,
    run: &RunSettings,
) -> Result<BTreeMap<u32, [f64; 3]>, Cancelled> {
    let test = |found: &mut Vec<(u32, [f64; 3])>, a: u32, b: u32| {
        let (va, vb) = (mesh.triangles[a as usize], mesh.triangles[b as usize]);
        if let Some(at) = meeting_point(va, mesh.corners(a as usize), vb, mesh.corners(b as usize)) {
            found.push((b, at));
        }
    };
    let found = if (patch as usize) < tree.order().len() / TRIANGLES_PER_LOOKUP {
        let of_patch = |a: u32| {
            run.check()?;
            let [p, q, r] = mesh.corners(a as usize).map(DVec3::from);
            let mut found = Vec::new();
            tree.meeting([p.min(q).min(r), p.max(q).max(r)], |b| {
                if b >= patch {
                    test(&mut found, a, b);
                }
            });
            Ok(found)
        };
        (0..patch).into_par_iter().with_min_len(64).map(of_patch).collect::<Result<_, Cancelled>>()?
    } else {
        tree.pairs(run, Vec::new, |found, a, b| {
            if a < patch && b >= patch {
                test(found, a, b);
            }
        })?
    };
    let mut all: Vec<_> = found.into_iter().flatten().collect();
    // The order of tasks is not that of the triangles.
    all.sort_by(|a, b| b.partial_cmp(a).unwrap_or(Ordering::Equal));
    Ok(all.into_iter().collect())
}

/// Two triangles that meet, and a point of both.
type FoundPair = Option<([u32; 2], [f64; 3])>;

/// Finds the first pair of triangles that meet, by number.
fn first_pair(mesh: &TriMesh, tree: &BoxTree, run: &RunSettings) -> Result<FoundPair, Cancelled> {
    let tasks = tree.pairs(
        run,
        || None,
        |found: &mut FoundPair, a, b| {
            if found.is_some_and(|(pair, _)| pair < [a, b]) {
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
