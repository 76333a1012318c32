//! The contour without the faces of the inset: an open mesh whose rims run along the boundary of S.

use crate::band::SignField;
use crate::contour::{Precision, contour_by_edge};
use crate::geom::triangle::TriangleSide;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;
use crate::thicken::ThickenError;
use crate::thicken::solid::crossings::SolidCrossings;
use crate::thicken::solid::edge_search::SolidFace;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// The changes that [`OpenMesh::remove_strays`] may make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// Triangles are taken back, or more of them left out.
    KeepOrDrop,
    /// More triangles are left out.
    Drop,
}

/// Section and shell: a contour of which some triangles are kept.
#[derive(Debug)]
pub(crate) struct OpenMesh {
    /// The whole contour.
    pub mesh: TriMesh,
    /// Topology of the whole contour.
    pub topology: Topology,
    /// Per triangle, whether it is kept.
    pub kept: Vec<bool>,
    /// Per triangle, the number of its lattice edge.
    pub edges: Vec<u32>,
    /// Few triangles, with all that are at rims among them; in any order, some more than once.
    near_rims: Vec<u32>,
}

impl OpenMesh {
    /// Contours the solid and leaves out the inset.
    pub fn new(
        signs: &SignField,
        found: &SolidCrossings,
        lattice: Lattice,
        precision: Precision,
        run: &RunSettings,
    ) -> Result<OpenMesh, ThickenError> {
        let (mesh, sizes) = contour_by_edge(signs, &found.crossings, lattice, precision, run)?;
        let edges: Vec<u32> =
            (0u32..).zip(&sizes).flat_map(|(n, &size)| std::iter::repeat_n(n, usize::from(size))).collect();
        let topology = run.install(|| Topology::new(&mesh));
        let kept: Vec<bool> = edges.iter().map(|&n| found.faces[n as usize] != SolidFace::Inset).collect();
        let mut open = OpenMesh { mesh, topology, kept, edges, near_rims: Vec::new() };
        let count = open.mesh.vertices.len() as u32;
        let at_rim: Vec<u32> =
            run.install(|| (0..count).into_par_iter().filter(|&v| open.is_at_rim(v)).collect());
        open.near_rims = at_rim.iter().flat_map(|&v| open.topology.around_vertex(v)).copied().collect();
        open.open_pinches(at_rim);
        Ok(open)
    }

    /// Leaves out these triangles, and `rings` rings of triangles around them.
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

    /// Leaves out triangles that would hang on a rim by one of these vertices alone.
    fn open_pinches(&mut self, mut at_rim: Vec<u32>) {
        while let Some(v) = at_rim.pop() {
            let around = self.topology.around_vertex(v).to_vec();
            let starts = |&&t: &&u32| {
                let corners = self.mesh.triangles[t as usize];
                TriangleSide::ALL.into_iter().any(|s| corners[s.index()] == v && self.is_rim(t, s))
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

    /// Leaves out a triangle. Returns whether it was kept before.
    fn drop(&mut self, t: usize) -> bool {
        let was_kept = std::mem::replace(&mut self.kept[t], false);
        if was_kept {
            self.record_change(t as u32);
        }
        was_kept
    }

    /// Records that rims may have come to a triangle and its neighbours.
    fn record_change(&mut self, t: u32) {
        self.near_rims.push(t);
        for side in TriangleSide::ALL {
            self.near_rims.extend(self.topology.around_edge(t, side).skip(1).map(|(other, _)| other));
        }
    }

    /// Whether a triangle is kept and the one across an edge is not.
    fn is_rim(&self, t: u32, side: TriangleSide) -> bool {
        self.kept[t as usize]
            && self.topology.around_edge(t, side).nth(1).is_none_or(|(other, _)| !self.kept[other as usize])
    }

    /// Closes the holes within stray rims, and drops the islands within them. Returns whether there
    /// were any.
    ///
    /// A hole or an island is a component of the triangles that are left out, or kept, without
    /// another rim.
    pub fn remove_strays(
        &mut self,
        rims: &[Vec<u32>],
        is_stray: impl Fn(usize) -> bool,
        change: Change,
    ) -> bool {
        let mut may_have = vec![true; self.mesh.vertices.len()];
        for (_, rim) in rims.iter().enumerate().filter(|&(n, _)| !is_stray(n)) {
            rim.iter().for_each(|&v| may_have[v as usize] = false);
        }
        let mut components = vec![0; self.kept.len()];
        let mut flips = Vec::new();
        let mut number = 0;
        for (_, rim) in rims.iter().enumerate().filter(|&(n, _)| is_stray(n)) {
            for &start in rim.iter().flat_map(|&v| self.topology.around_vertex(v)) {
                if components[start as usize] != 0 || change == Change::Drop && !self.kept[start as usize] {
                    continue;
                }
                number += 1;
                let component = self.component_of(start, number, &mut components, &may_have);
                flips.extend(component.unwrap_or_default());
            }
        }
        // Holes first: an island next to one is no island then.
        if flips.iter().any(|&t| !self.kept[t as usize]) {
            flips.retain(|&t| !self.kept[t as usize]);
        }
        let found = !flips.is_empty();
        for t in flips {
            self.kept[t as usize] = !self.kept[t as usize];
            self.record_change(t);
        }
        found
    }

    /// Collects the component of `start`: the triangles joined to it by edges that are kept, or
    /// left out, as `start` is. `None` when it has a vertex that it may not have.
    ///
    /// The triangles get `number` in `components`, where 0 stands for none. Most of a large
    /// component is not looked at: a walk that comes to a component that was given up belongs to
    /// it.
    fn component_of(
        &self,
        start: u32,
        number: u32,
        components: &mut [u32],
        may_have: &[bool],
    ) -> Option<Vec<u32>> {
        let kept = self.kept[start as usize];
        let mut component = vec![start];
        components[start as usize] = number;
        let mut next = 0;
        while let Some(&t) = component.get(next) {
            next += 1;
            let corners = self.mesh.triangles[t as usize];
            if !corners.into_iter().all(|v| may_have[v as usize]) {
                return None;
            }
            for side in TriangleSide::ALL {
                let mut neighbours = self.topology.around_edge(t, side).skip(1).peekable();
                // The rest of a large component of the inset was not contoured.
                neighbours.peek()?;
                for (other, _) in neighbours {
                    if self.kept[other as usize] != kept || components[other as usize] == number {
                        continue;
                    }
                    if components[other as usize] != 0 {
                        return None;
                    }
                    components[other as usize] = number;
                    component.push(other);
                }
            }
        }
        Some(component)
    }

    /// Returns the vertices of each rim, in the direction in which the kept triangles run through
    /// its edges.
    pub fn rims(&self) -> Vec<Vec<u32>> {
        let mut near = self.near_rims.clone();
        near.sort_unstable();
        near.dedup();
        let mut next = BTreeMap::new();
        for t in near {
            let triangle = self.mesh.triangles[t as usize];
            for side in TriangleSide::ALL.into_iter().filter(|&side| self.is_rim(t, side)) {
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
