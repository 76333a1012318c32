//! The triangles of a patch, and the edges between them.

use super::bounds::Bounds;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;

type Point = [f64; 3];

/// A triangle of a patch.
#[derive(Clone, Copy, Debug)]
pub struct PatchTriangle {
    /// Its number in the mesh.
    pub number: usize,
    /// The numbers of its vertices in the mesh.
    pub vertices: [u32; 3],
    /// Their positions.
    pub corners: [Point; 3],
    /// Which of the patch's homes it belongs to and may not leave.
    pub home: u8,
}

/// The home of the triangles that a patch adds: its own leaf.
pub const OWN_HOME: u8 = 13;

/// The homes of a patch: around the leaf and each of its 26 neighbours, z fastest.
pub type Homes = [Bounds; 27];

impl PatchTriangle {
    /// The triangle with vertex `old` replaced by `new` at a position; the same if it is none of
    /// its vertices.
    pub fn with(mut self, old: u32, new: u32, at: Point) -> PatchTriangle {
        if let Some(k) = self.place(old) {
            self.vertices[k] = new;
            self.corners[k] = at;
        }
        self
    }

    #[inline]
    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of_triangle(self.corners)
    }

    pub(super) fn has_area(&self) -> bool {
        projection_axis(self.corners).is_some()
    }

    pub(super) fn meets(&self, other: &PatchTriangle) -> bool {
        meeting_point(self.vertices, self.corners, other.vertices, other.corners).is_some()
    }

    /// The place of a vertex in the triangle.
    pub(super) fn place(&self, vertex: u32) -> Option<usize> {
        self.vertices.iter().position(|&v| v == vertex)
    }
}

/// The edge between two triangles, seen from the first: it runs from `a` to `b` there.
#[derive(Clone, Copy, Debug)]
pub struct PatchEdge {
    pub(super) triangles: [usize; 2],
    /// The ends of the edge and the vertices opposite to it in the first and in the second
    /// triangle.
    pub a: (u32, Point),
    /// See `a`.
    pub b: (u32, Point),
    /// See `a`.
    pub c: (u32, Point),
    /// See `a`.
    pub d: (u32, Point),
}
