//! Holes of the patch that are too narrow for the lattice, and the caps that close them.
//!
//! A hole that is narrower than some voxels has no wall on the lattice: no node lies in it, or its
//! wall grows together with the wall of the hole next to it. Such a hole is closed before anything
//! else, by a cap on its own vertices (\[WC13\] section 4.2 closes holes in the same way). The
//! patch with its caps is thickened then.

use super::boundary::Boundary;
use super::minimal_triangulation::Polygon;
use crate::geom::box_tree::BoxTree;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::{Topology, TriMesh};
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Width, in voxels, below which a hole is closed at once: there need not be a node in it.
const NARROW: f64 = 2.0;

/// Width, in voxels, below which a hole that touches another boundary loop in a vertex is closed at
/// once: the pillar below such a vertex fills three voxels, and a node must be left.
const NARROW_TOUCHING: f64 = 4.0;

/// Maximum width, in voxels, of holes that are closed when they have proved to be in the way. Wider
/// ones are shape, and a lattice that cannot wall them is too coarse.
const MAX_CAPPED_WIDTH: f64 = 12.0;

/// Minimum component of the mean normal along a hole in the direction of its cap's normal. The
/// boundary of a disc has -1, the end of a tube 0, and neither is a hole.
const MIN_ALIGNMENT: f64 = 0.5;

/// Maximum number of triangulations of a hole, each without the triangles that met something
/// before. Each try forbids one triangle at least, and most holes have a dozen.
const MAX_TRIES: usize = 30;

/// A boundary loop around a hole.
#[derive(Clone, Debug)]
struct Hole {
    polygon: Polygon,
    /// Four times the area over the length, in model units: the diameter of a round hole, the edge
    /// of a square one.
    width: f64,
    /// Whether the loop touches a boundary loop in a vertex.
    touches: bool,
}

/// The holes of a patch, by number.
#[derive(Debug)]
pub(crate) struct Holes<'a> {
    patch: &'a TriMesh,
    holes: Vec<Hole>,
    /// Number of the hole at each boundary edge.
    of_edge: BTreeMap<[u32; 2], usize>,
}

/// A patch with some of its holes closed.
#[derive(Debug)]
pub(crate) struct CappedPatch {
    /// The patch's triangles, then the triangles of the caps.
    pub mesh: TriMesh,
    /// A point of each hole that was closed.
    pub capped: Vec<[f64; 3]>,
}

impl<'a> Holes<'a> {
    /// Finds the boundary loops of `patch` that are holes in it.
    pub fn new(patch: &'a TriMesh, topology: &Topology, boundary: &Boundary) -> Holes<'a> {
        let mut holes = Vec::new();
        let mut of_edge = BTreeMap::new();
        for around in &boundary.loops {
            let Some(hole) = Hole::new(patch, topology, boundary, around) else { continue };
            for (n, &a) in around.iter().enumerate() {
                of_edge.insert([a, around[(n + 1) % around.len()]], holes.len());
            }
            holes.push(hole);
        }
        Holes { patch, holes, of_edge }
    }

    /// Returns the holes that are too narrow for a lattice.
    pub fn too_narrow(&self, voxel: f64) -> BTreeSet<usize> {
        let is_narrow =
            |hole: &Hole| hole.width < voxel * if hole.touches { NARROW_TOUCHING } else { NARROW };
        (0..self.holes.len()).filter(|&n| is_narrow(&self.holes[n])).collect()
    }

    /// Returns the holes at these boundary edges that are not too wide to be closed.
    pub fn at_edges(&self, edges: &[[u32; 2]], voxel: f64) -> BTreeSet<usize> {
        let numbers = edges.iter().filter_map(|edge| self.of_edge.get(edge).copied());
        numbers.filter(|&n| self.holes[n].width < MAX_CAPPED_WIDTH * voxel).collect()
    }

    /// Closes the given holes by caps, as far as the caps meet nothing.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn cap(&self, which: &BTreeSet<usize>, run: &RunSettings) -> Result<CappedPatch, Cancelled> {
        let patch = self.patch;
        let mut mesh = patch.clone();
        let mut capped = Vec::new();
        if which.is_empty() {
            return Ok(CappedPatch { mesh, capped });
        }
        let tree = BoxTree::new(
            &patch.vertices,
            &patch.triangles,
            (0..patch.triangles.len() as u32).into_par_iter(),
        );
        let which: Vec<usize> = which.iter().copied().collect();
        let caps: Vec<Option<Vec<[u32; 3]>>> = which
            .par_iter()
            .map(|&n| {
                run.check()?;
                Ok(self.holes[n].cap(patch, &tree))
            })
            .collect::<Result<_, Cancelled>>()?;
        // Of two caps that meet, the second one is dropped.
        let mut owners = Vec::new();
        for (n, cap) in caps.iter().enumerate() {
            for &triangle in cap.iter().flatten() {
                owners.push(n);
                mesh.triangles.push(triangle);
            }
        }
        let first = patch.triangles.len() as u32;
        let tree = BoxTree::new(
            &mesh.vertices,
            &mesh.triangles,
            (first..mesh.triangles.len() as u32).into_par_iter(),
        );
        let pairs = tree.pairs(run, Vec::new, |found: &mut Vec<[usize; 2]>, a, b| {
            let [p, q] = [a, b].map(|t| owners[(t - first) as usize]);
            let [va, vb] = [a, b].map(|t| mesh.triangles[t as usize]);
            let shared = va.iter().filter(|v| vb.contains(v)).count();
            let meet = || meeting_point(va, mesh.corners(a as usize), vb, mesh.corners(b as usize)).is_some();
            if p != q && (shared >= 2 || meet()) {
                found.push([p.min(q), p.max(q)]);
            }
        })?;
        let mut pairs: Vec<[usize; 2]> = pairs.into_iter().flatten().collect();
        pairs.sort_unstable();
        let mut dropped = BTreeSet::new();
        for [p, q] in pairs {
            if !dropped.contains(&p) {
                dropped.insert(q);
            }
        }
        mesh.triangles.truncate(patch.triangles.len());
        for (n, cap) in caps.into_iter().enumerate().filter(|(n, _)| !dropped.contains(n)) {
            let Some(cap) = cap else { continue };
            capped.push(self.holes[which[n]].polygon.points[0].to_array());
            mesh.triangles.extend(cap);
        }
        Ok(CappedPatch { mesh, capped })
    }
}

impl Hole {
    /// Returns the hole within a boundary loop, if the loop is around one.
    fn new(patch: &TriMesh, topology: &Topology, boundary: &Boundary, around: &[u32]) -> Option<Hole> {
        let vertices: Vec<u32> = around.iter().rev().copied().collect();
        let points: Vec<DVec3> = vertices.iter().map(|&v| DVec3::from(patch.vertices[v as usize])).collect();
        let (mut area, mut normals, mut length) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (n, &a) in points.iter().enumerate() {
            let next = (n + 1) % points.len();
            let b = points[next];
            area += 0.5 * (a - points[0]).cross(b - points[0]);
            let edge = (b - a).length();
            length += edge;
            normals += edge * normal_at(patch, topology, [vertices[next], vertices[n]]);
        }
        let is_hole = normals.dot(area.normalize_or_zero()) > MIN_ALIGNMENT * length;
        let touches = vertices.iter().any(|v| boundary.touching.binary_search(v).is_ok());
        let polygon = Polygon { vertices, points, forbidden: BTreeSet::new() };
        is_hole.then(|| Hole { polygon, width: 4.0 * area.length() / length, touches })
    }

    /// Finds triangles over the hole that meet nothing of the patch, and have no edge of it as a
    /// diagonal.
    fn cap(&self, patch: &TriMesh, tree: &BoxTree) -> Option<Vec<[u32; 3]>> {
        let mut polygon = self.polygon.clone();
        let is_taken = |a: u32, b: u32| {
            let mut found = false;
            tree.near(DVec3::from(patch.vertices[a as usize]), 0.0, |t| {
                let triangle = patch.triangles[t as usize];
                found |= triangle.contains(&a) && triangle.contains(&b);
            });
            found
        };
        for _ in 0..MAX_TRIES {
            let indices = polygon.minimal_triangulation(is_taken)?;
            let triangles: Vec<[u32; 3]> = indices.iter().map(|&t| polygon.triangle(t)).collect();
            let mut bad: BTreeSet<[usize; 3]> = BTreeSet::new();
            for (n, &t) in triangles.iter().enumerate() {
                let meets_own = triangles[..n].iter().any(|&other| do_meet(patch, t, other));
                if meets_own || meets(patch, tree, t) {
                    bad.insert(indices[n]);
                }
            }
            if bad.is_empty() {
                return Some(triangles);
            }
            polygon.forbidden.append(&mut bad);
        }
        None
    }
}

/// Returns the unit normal of the triangle that runs along a boundary edge.
fn normal_at(patch: &TriMesh, topology: &Topology, [a, b]: [u32; 2]) -> DVec3 {
    let has_edge = |&&t: &&u32| {
        let [p, q, r] = patch.triangles[t as usize];
        [[p, q], [q, r], [r, p]].contains(&[a, b])
    };
    topology.around_vertex(a).iter().find(has_edge).map_or(DVec3::ZERO, |&t| {
        let [p, q, r] = patch.corners(t as usize).map(DVec3::from);
        (q - p).cross(r - p).normalize_or_zero()
    })
}

/// Whether a triangle has no area or meets one of the patch.
fn meets(patch: &TriMesh, tree: &BoxTree, t: [u32; 3]) -> bool {
    let corners = t.map(|v| patch.vertices[v as usize]);
    if projection_axis(corners).is_none() {
        return true;
    }
    let [a, b, c] = corners.map(DVec3::from);
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    let mut found = false;
    tree.meeting([lo, hi], |n| {
        let n = n as usize;
        found |= meeting_point(t, corners, patch.triangles[n], patch.corners(n)).is_some();
    });
    found
}

/// Whether two triangles of a cap have more in common than they may: an edge that both run through
/// the same way, or a point.
fn do_meet(patch: &TriMesh, a: [u32; 3], b: [u32; 3]) -> bool {
    let corners = |t: [u32; 3]| t.map(|v| patch.vertices[v as usize]);
    let shared: Vec<u32> = a.into_iter().filter(|v| b.contains(v)).collect();
    let runs = |t: [u32; 3], [p, q]: [u32; 2]| (0..3).any(|k| [t[k], t[(k + 1) % 3]] == [p, q]);
    // Along a common edge the two run in opposite directions.
    let runs_alike = match shared[..] {
        [p, q] => runs(a, [p, q]) == runs(b, [p, q]),
        _ => shared.len() == 3,
    };
    runs_alike || meeting_point(a, corners(a), b, corners(b)).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns cells of width 1 of a square grid, turned towards +z.
    fn cells(n: u32, is_there: impl Fn(u32, u32) -> bool) -> TriMesh {
        let vertices =
            (0..=n).flat_map(|j| (0..=n).map(move |i| [f64::from(i), f64::from(j), 0.0])).collect();
        let all = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).filter(|&(i, j)| is_there(i, j));
        let number = |i: u32, j: u32| j * (n + 1) + i;
        let triangles = all.flat_map(|(i, j)| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        TriMesh { vertices, triangles: triangles.collect() }
    }

    fn with_holes<T>(patch: &TriMesh, then: impl FnOnce(&Boundary, Holes<'_>) -> T) -> T {
        let topology = Topology::new(patch);
        let boundary = Boundary::new(patch, &topology).unwrap();
        let holes = Holes::new(patch, &topology, &boundary);
        then(&boundary, holes)
    }

    #[test]
    fn the_rim_of_a_patch_is_no_hole_in_it() {
        let patch = cells(7, |i, j| (i, j) != (3, 3));
        with_holes(&patch, |boundary, holes| {
            assert_eq!((boundary.loops.len(), holes.holes.len()), (2, 1));
            assert!((holes.holes[0].width - 1.0).abs() < 1e-12);
            assert_eq!((holes.too_narrow(0.51).len(), holes.too_narrow(0.49).len()), (1, 0));
            let rim = boundary.loops.iter().find(|around| around.len() == 28).unwrap();
            let inner = boundary.loops.iter().find(|around| around.len() == 4).unwrap();
            assert!(holes.at_edges(&[[rim[0], rim[1]]], 100.0).is_empty());
            assert_eq!(holes.at_edges(&[[inner[0], inner[1]]], 0.1).len(), 1);
            assert!(holes.at_edges(&[[inner[0], inner[1]]], 0.08).is_empty(), "too wide");
        });
    }

    #[test]
    fn holes_that_touch_are_closed_together() {
        let run = RunSettings::with_threads(1).unwrap();
        let patch = cells(8, |i, j| (i, j) != (3, 3) && (i, j) != (4, 4));
        with_holes(&patch, |boundary, holes| {
            assert_eq!(boundary.touching.len(), 1);
            assert_eq!((holes.too_narrow(0.26).len(), holes.too_narrow(0.24).len()), (2, 0), "touching");
            let capped = holes.cap(&holes.too_narrow(1.0), &run).unwrap();
            assert_eq!(capped.capped.len(), 2);
            assert_eq!(capped.mesh.triangles[..patch.triangles.len()], patch.triangles);
            assert_eq!(capped.mesh.triangles.len(), 2 * 64);
            let topology = Topology::new(&capped.mesh);
            let closed = Boundary::new(&capped.mesh, &topology).unwrap();
            assert_eq!((closed.loops.len(), closed.touching.len()), (1, 0));
        });
    }

    #[test]
    fn what_is_in_the_way_of_a_cap_keeps_the_hole_open() {
        let run = RunSettings::with_threads(1).unwrap();
        let mut patch = cells(5, |i, j| (i, j) != (2, 2));
        let first = patch.vertices.len() as u32;
        patch.vertices.extend([[2.6, 2.4, -1.0], [2.6, 2.4, 1.0], [2.4, 2.6, 0.0]]);
        patch.triangles.push([first, first + 1, first + 2]);
        with_holes(&patch, |_, holes| {
            let capped = holes.cap(&holes.too_narrow(1.0), &run).unwrap();
            assert!(capped.capped.is_empty() && capped.mesh.triangles == patch.triangles);
        });
    }
}
