//! A mesh whose triangles are known by leaf, so that leaves can be changed one by one.

use super::changes::{Changes, NEW_TRIANGLE, NEW_VERTEX};
use crate::band::LeafId;
use crate::mesh::TriMesh;
use std::ops::Range;

/// Vertices with consecutive numbers that belong to one leaf.
#[derive(Clone, Debug)]
pub struct VertexRun {
    /// The leaf.
    pub leaf: LeafId,
    /// The numbers of the vertices.
    pub numbers: Range<u32>,
}

/// A mesh whose triangles are known by leaf.
#[derive(Debug)]
pub struct LeafMesh {
    /// The mesh. Removed triangles have the vertices [`GONE`].
    pub mesh: TriMesh,
    /// The number of the first triangle of each leaf, and the number of all at the end. Added
    /// triangles come after these.
    pub firsts: Vec<usize>,
    /// The grid edge that each triangle lies around: the number of its lower node in the leaf, and
    /// [`AXIS_STRIDE`] times its axis.
    ///
    /// The edges ascend within a leaf, but for the bit [`CHANGED`] of changed triangles.
    pub edges: Vec<u16>,
    /// Changed triangles by leaf, which may no longer lie around their grid edge.
    pub changed: Vec<Vec<usize>>,
    /// Added triangles by leaf.
    pub added: Vec<Vec<usize>>,
    /// The leaf of each vertex, in runs of consecutive numbers.
    pub runs: Vec<VertexRun>,
    /// Removed vertices, in the order of their removal.
    pub removed: Vec<u32>,
}

/// The difference between the edge numbers of two axes: the nodes of a leaf.
pub const AXIS_STRIDE: u16 = 512;

/// Marks the edge of a triangle that may no longer lie around it.
pub const CHANGED: u16 = 1 << 15;

/// The vertices of a removed triangle. Meshes with vertex numbers that large are not changed.
pub const GONE: [u32; 3] = [u32::MAX; 3];

impl LeafMesh {
    /// Returns the numbers of the triangles of a leaf.
    pub fn triangles(&self, leaf: LeafId) -> impl Iterator<Item = usize> + '_ {
        let n = leaf.0 as usize;
        let all = (self.firsts[n]..self.firsts[n + 1]).chain(self.added[n].iter().copied());
        all.filter(|&t| self.mesh.triangles[t] != GONE)
    }

    /// Returns the number of triangles of a leaf.
    pub fn count(&self, leaf: LeafId) -> usize {
        let n = leaf.0 as usize;
        let left = self.changed_or_added(leaf).count();
        self.firsts[n + 1] - self.firsts[n] - self.changed[n].len() + left
    }

    /// Returns the numbers of those triangles of a leaf that were changed or added, and are not
    /// gone.
    ///
    /// No other triangle can be gone.
    pub fn changed_or_added(&self, leaf: LeafId) -> impl Iterator<Item = usize> + '_ {
        let n = leaf.0 as usize;
        let all = self.changed[n].iter().chain(&self.added[n]).copied();
        all.filter(|&t| self.mesh.triangles[t] != GONE)
    }

    /// Applies the changes of a patch around `leaf`.
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
            // Added triangles have no edge.
            if let Some(edge) = self.edges.get_mut(number).filter(|edge| **edge & CHANGED == 0) {
                *edge |= CHANGED;
                let leaf = self.firsts.partition_point(|&first| first <= number) - 1;
                self.changed[leaf].push(number);
            }
        }
        self.removed.extend(changes.removed_vertices.into_iter().map(vertex));
    }

    /// Returns the positions of the vertices of a triangle.
    pub fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.mesh.corners(triangle)
    }
}
