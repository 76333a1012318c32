//! Intersecting pairs of triangles.

use super::report::{IntersectingPair, IntersectionReport};
use super::welded::Welded;
use crate::geom::box_tree::BoxTree;
use crate::geom::triangle_pair;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};

/// Number of pairs that are located. More would only fill the screen.
const LOCATED: usize = 10;

/// The pairs that one task found.
#[derive(Default)]
struct Found {
    tested: u64,
    pairs: u64,
    /// The first pairs, and some more.
    first: Vec<IntersectingPair>,
}

impl Found {
    fn add(&mut self, pair: IntersectingPair) {
        self.pairs += 1;
        self.first.push(pair);
        // Bounded also when everything intersects everything.
        if self.first.len() >= 64 * LOCATED {
            self.keep_first();
        }
    }

    fn keep_first(&mut self) {
        self.first.sort_unstable_by_key(|pair| pair.triangles);
        self.first.truncate(LOCATED);
    }
}

/// Returns a point in which two triangles of a mesh meet, elsewhere than in the vertices and edges
/// that they share.
pub(super) fn meeting_point(mesh: &TriMesh, a: u32, b: u32) -> Option<[f64; 3]> {
    let (va, vb) = (mesh.triangles[a as usize], mesh.triangles[b as usize]);
    triangle_pair::meeting_point(va, mesh.corners(a as usize), vb, mesh.corners(b as usize))
}

/// Finds the intersecting pairs of a mesh, by a tree over its triangles that have area.
pub(super) fn intersections(
    mesh: &Welded,
    tree: &BoxTree,
    run: &RunSettings,
) -> Result<IntersectionReport, Cancelled> {
    let tasks = tree.pairs(run, Found::default, |found, a, b| {
        found.tested += 1;
        if let Some(point) = meeting_point(&mesh.mesh, a, b) {
            found.add(IntersectingPair { triangles: [a, b], point });
        }
    })?;
    let mut all = Found::default();
    for task in tasks {
        all.tested += task.tested;
        all.pairs += task.pairs;
        all.first.extend(task.first);
    }
    all.keep_first();
    for pair in &mut all.first {
        pair.triangles = pair.triangles.map(|t| mesh.in_file(t));
    }
    Ok(IntersectionReport { pairs: all.pairs, tested: all.tested, first: all.first })
}
