//! The contour without the faces below the patch: an open mesh whose rims run along the boundary of S.

use crate::band::SignField;
use crate::contour::{Precision, contour_by_edge};
use crate::error::Error;
use crate::geom::triangle::Side;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;
use crate::thicken::solid::crossings::SolidCrossings;
use crate::thicken::solid::edge_search::Part;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What [`OpenMesh::close`] may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// Keep triangles, or leave more of them out.
    Both,
    /// Leave more of them out.
    Drop,
}

/// Section and shell: the triangles of a contour that are kept.
#[derive(Debug)]
pub(crate) struct OpenMesh {
    /// The whole contour.
    pub mesh: TriMesh,
    pub topology: Topology,
    /// Per triangle whether it is in the result.
    pub kept: Vec<bool>,
    /// Per triangle the number of the lattice edge that it is at.
    pub edges: Vec<u32>,
    /// All triangles at rims are among these, which are few beside all. In any order, some more than once.
    near_rims: Vec<u32>,
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
        let mut open = OpenMesh { mesh, topology, kept, edges, near_rims: Vec::new() };
        let count = open.mesh.vertices.len() as u32;
        let at_rim: Vec<u32> =
            run.install(|| (0..count).into_par_iter().filter(|&v| open.is_at_rim(v)).collect());
        open.near_rims = at_rim.iter().flat_map(|&v| open.topology.around_vertex(v)).copied().collect();
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
                if self.drop(t) {
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
            let around = self.topology.around_vertex(v).to_vec();
            let starts = |&&t: &&u32| {
                let corners = self.mesh.triangles[t as usize];
                Side::ALL.into_iter().any(|s| corners[s.index()] == v && self.is_rim(t, s))
            };
            if around.iter().filter(starts).count() > 1 {
                for t in around {
                    if self.drop(t as usize) {
                        at_rim.extend(self.mesh.triangles[t as usize]);
                    }
                }
            }
        }
    }

    /// Leaves out a triangle. Says whether it was there.
    fn drop(&mut self, t: usize) -> bool {
        let was_kept = std::mem::replace(&mut self.kept[t], false);
        if was_kept {
            self.changed(t as u32);
        }
        was_kept
    }

    /// Remembers that rims may have come to a triangle and those beside it.
    fn changed(&mut self, t: u32) {
        self.near_rims.push(t);
        for side in Side::ALL {
            self.near_rims.extend(self.topology.around_edge(t, side).skip(1).map(|(other, _)| other));
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
        let mut parts = vec![0; self.kept.len()];
        let mut flips = Vec::new();
        let mut number = 0;
        for (_, rim) in rims.iter().enumerate().filter(|&(n, _)| wanted(n)) {
            for &start in rim.iter().flat_map(|&v| self.topology.around_vertex(v)) {
                if parts[start as usize] != 0 || change == Change::Drop && !self.kept[start as usize] {
                    continue;
                }
                number += 1;
                flips.extend(self.part_of(start, number, &mut parts, &is_wanted).unwrap_or_default());
            }
        }
        // Holes first: an island beside one is no island then.
        if flips.iter().any(|&t| !self.kept[t as usize]) {
            flips.retain(|&t| !self.kept[t as usize]);
        }
        let found = !flips.is_empty();
        for t in flips {
            self.kept[t as usize] = !self.kept[t as usize];
            self.changed(t);
        }
        found
    }

    /// The triangles joined to one by edges that are kept, or not, as it is; `None` when a vertex of theirs is at a rim that is
    /// not wanted. They get `number` in `parts`, where 0 stands for no part. Most of a large part is not looked at: what
    /// comes from another side to a part that was given up belongs to it.
    fn part_of(&self, start: u32, number: u32, parts: &mut [u32], is_wanted: &[bool]) -> Option<Vec<u32>> {
        let kept = self.kept[start as usize];
        let mut part = vec![start];
        parts[start as usize] = number;
        let mut next = 0;
        while let Some(&t) = part.get(next) {
            next += 1;
            let corners = self.mesh.triangles[t as usize];
            if !corners.into_iter().all(|v| is_wanted[v as usize]) {
                return None;
            }
            for side in Side::ALL {
                let mut beside = self.topology.around_edge(t, side).skip(1).peekable();
                // The rest of a large part of the lid is not there.
                beside.peek()?;
                for (other, _) in beside {
                    if self.kept[other as usize] != kept || parts[other as usize] == number {
                        continue;
                    }
                    if parts[other as usize] != 0 {
                        return None;
                    }
                    parts[other as usize] = number;
                    part.push(other);
                }
            }
        }
        Some(part)
    }

    /// The vertices of each rim, in the direction in which the kept triangles run through its edges.
    pub fn rims(&self) -> Vec<Vec<u32>> {
        let mut near = self.near_rims.clone();
        near.sort_unstable();
        near.dedup();
        let mut next = BTreeMap::new();
        for t in near {
            let triangle = self.mesh.triangles[t as usize];
            for side in Side::ALL.into_iter().filter(|&side| self.is_rim(t, side)) {
                next.insert(triangle[side.index()], triangle[side.next().index()]);
            }
        }
        let mut rims = Vec::new();
        while let Some((&start, _)) = next.first_key_value() {
            let (mut at, mut rim) = (start, Vec::new());
            while let Some(to) = next.remove(&at) {
                rim.push(at);
                at = to;
            }
            rims.push(rim);
        }
        rims
    }
}
