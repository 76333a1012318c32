//! The contour without the faces below the patch: an open mesh whose rims run along the boundary of S.

use super::crossings::{Part, SolidCrossings};
use crate::band::SignField;
use crate::contour::{Precision, contour_by_edge};
use crate::error::Error;
use crate::geom::triangle::Side;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;
use std::collections::BTreeSet;

/// What [`OpenMesh::close`] may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// Keep triangles, or leave more of them out.
    Both,
    /// Leave more of them out.
    Drop,
}

/// Section and shell: the triangles of a contour that are kept.
#[derive(Debug)]
pub(super) struct OpenMesh {
    /// The whole contour.
    pub mesh: TriMesh,
    pub topology: Topology,
    /// Per triangle whether it is in the result.
    pub kept: Vec<bool>,
    /// Per triangle the number of the lattice edge that it is at.
    pub edges: Vec<u32>,
}

impl OpenMesh {
    /// Contours the solid and leaves out the lid.
    pub fn new(
        signs: &SignField,
        found: &SolidCrossings,
        lattice: Lattice,
        precision: Precision,
        run: &RunSettings,
    ) -> Result<OpenMesh, Error> {
        let (mesh, sizes) = contour_by_edge(signs, &found.crossings, lattice, precision, run)?;
        let edges: Vec<u32> =
            (0u32..).zip(&sizes).flat_map(|(n, &size)| std::iter::repeat_n(n, usize::from(size))).collect();
        let topology = run.install(|| Topology::new(&mesh));
        let kept: Vec<bool> = edges.iter().map(|&n| found.parts[n as usize] != Part::Lid).collect();
        let mut open = OpenMesh { mesh, topology, kept, edges };
        let at_rim = (0..open.mesh.vertices.len() as u32).filter(|&v| open.is_at_rim(v)).collect();
        open.open_pinches(at_rim);
        Ok(open)
    }

    /// Leaves out some more triangles, and `rings` of those around them.
    pub fn drop_around(&mut self, triangles: impl IntoIterator<Item = usize>, rings: usize) {
        let mut front: Vec<usize> = triangles.into_iter().collect();
        let mut at_rim = Vec::new();
        let mut seen: BTreeSet<usize> = front.iter().copied().collect();
        for ring in 0..=rings {
            for &t in &front {
                if std::mem::replace(&mut self.kept[t], false) {
                    at_rim.extend(self.mesh.triangles[t]);
                }
            }
            if ring == rings {
                break;
            }
            let vertices = front.iter().flat_map(|&t| self.mesh.triangles[t]);
            let around = vertices.flat_map(|v| self.topology.around_vertex(v)).map(|&t| t as usize);
            front = around.filter(|&t| self.kept[t] && seen.insert(t)).collect();
        }
        self.open_pinches(at_rim);
    }

    /// Whether a vertex has triangles that are kept and others that are not.
    fn is_at_rim(&self, v: u32) -> bool {
        let mut around = self.topology.around_vertex(v).iter().map(|&t| self.kept[t as usize]);
        let first = around.next();
        around.any(|kept| Some(kept) != first)
    }

    /// Leaves out what would hang on a rim by one of these vertices alone.
    fn open_pinches(&mut self, mut at_rim: Vec<u32>) {
        while let Some(v) = at_rim.pop() {
            let around = self.topology.around_vertex(v);
            let starts = |&&t: &&u32| {
                let corners = self.mesh.triangles[t as usize];
                Side::ALL.into_iter().any(|s| corners[s.index()] == v && self.is_rim(t, s))
            };
            if around.iter().filter(starts).count() > 1 {
                for &t in around {
                    if std::mem::replace(&mut self.kept[t as usize], false) {
                        at_rim.extend(self.mesh.triangles[t as usize]);
                    }
                }
            }
        }
    }

    /// Whether a triangle is kept and the one across an edge is not.
    fn is_rim(&self, t: u32, side: Side) -> bool {
        self.kept[t as usize]
            && self.topology.around_edge(t, side).nth(1).is_none_or(|(other, _)| !self.kept[other as usize])
    }

    /// Closes the holes that these rims are around, and drops the islands that they bound: those parts of the contour,
    /// left out or not, that have no other rim. Says whether there were any.
    pub fn close(&mut self, rims: &[Vec<u32>], wanted: impl Fn(usize) -> bool, change: Change) -> bool {
        let mut is_wanted = vec![true; self.mesh.vertices.len()];
        for (_, rim) in rims.iter().enumerate().filter(|&(n, _)| !wanted(n)) {
            rim.iter().for_each(|&v| is_wanted[v as usize] = false);
        }
        let mut seen = vec![false; self.kept.len()];
        let mut flips = Vec::new();
        for (_, rim) in rims.iter().enumerate().filter(|&(n, _)| wanted(n)) {
            for &start in rim.iter().flat_map(|&v| self.topology.around_vertex(v)) {
                if seen[start as usize] || change == Change::Drop && !self.kept[start as usize] {
                    continue;
                }
                let (part, is_whole) = self.part_of(start, &mut seen, &is_wanted);
                if is_whole {
                    flips.extend(part);
                }
            }
        }
        // Holes first: an island beside one is no island then.
        if flips.iter().any(|&t| !self.kept[t as usize]) {
            flips.retain(|&t| !self.kept[t as usize]);
        }
        let found = !flips.is_empty();
        for t in flips {
            self.kept[t as usize] = !self.kept[t as usize];
        }
        found
    }

    /// The triangles joined to one by edges that are kept, or not, as it is; whether all of its vertices at rims are
    /// wanted ones.
    fn part_of(&self, start: u32, seen: &mut [bool], is_wanted: &[bool]) -> (Vec<u32>, bool) {
        let kept = self.kept[start as usize];
        let (mut part, mut is_whole, mut next) = (Vec::new(), true, vec![start]);
        seen[start as usize] = true;
        while let Some(t) = next.pop() {
            part.push(t);
            let corners = self.mesh.triangles[t as usize];
            is_whole &= corners.into_iter().all(|v| is_wanted[v as usize]);
            for side in Side::ALL {
                for (other, _) in self.topology.around_edge(t, side).skip(1) {
                    if self.kept[other as usize] == kept
                        && !std::mem::replace(&mut seen[other as usize], true)
                    {
                        next.push(other);
                    }
                }
            }
        }
        (part, is_whole)
    }

    /// The vertices of each rim, in the direction in which the kept triangles run through its edges.
    pub fn rims(&self) -> Vec<Vec<u32>> {
        let mut next = vec![u32::MAX; self.mesh.vertices.len()];
        for (t, triangle) in (0u32..).zip(&self.mesh.triangles) {
            if !self.kept[t as usize] {
                continue;
            }
            for side in Side::ALL.into_iter().filter(|&side| self.is_rim(t, side)) {
                next[triangle[side.index()] as usize] = triangle[side.next().index()];
            }
        }
        let mut rims = Vec::new();
        for start in 0..next.len() as u32 {
            let (mut at, mut rim) = (start, Vec::new());
            while next[at as usize] != u32::MAX {
                rim.push(at);
                at = std::mem::replace(&mut next[at as usize], u32::MAX);
            }
            if !rim.is_empty() {
                rims.push(rim);
            }
        }
        rims
    }
}

/// Drops vertices from number `first` on that no triangle has.
pub(super) fn without_idle_vertices(mesh: &mut TriMesh, first: usize) {
    let mut used = vec![false; mesh.vertices.len()];
    mesh.triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
    let mut numbers: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    let mut next = first;
    for v in first..mesh.vertices.len() {
        numbers[v] = next as u32;
        if used[v] {
            mesh.vertices[next] = mesh.vertices[v];
            next += 1;
        }
    }
    mesh.vertices.truncate(next);
    mesh.triangles.as_flattened_mut().iter_mut().for_each(|v| *v = numbers[*v as usize]);
}
