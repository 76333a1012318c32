//! The triangles of a patch, and the edges between them.

use super::bounds::Bounds;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;

/// A triangle of a patch.
#[derive(Clone, Copy, Debug)]
pub struct PatchTriangle {
    /// The number of the triangle in the mesh.
    pub number: usize,
    /// The numbers of the vertices in the mesh.
    pub vertices: [u32; 3],
    /// The positions of the vertices.
    pub corners: [[f64; 3]; 3],
    /// The number of the home that the triangle may not leave.
    pub home: u8,
}

/// The home of added triangles: the patch's own leaf.
pub const OWN_HOME: u8 = 13;

/// The homes of a patch: boxes around the leaf and each of its 26 neighbours, z fastest.
pub type Homes = [Bounds; 27];

impl PatchTriangle {
    /// Returns the triangle with vertex `old`, if it has it, replaced by `new` at a position.
    pub fn with(mut self, old: u32, new: u32, at: [f64; 3]) -> PatchTriangle {
        if let Some(k) = self.corner_of(old) {
            self.vertices[k] = new;
            self.corners[k] = at;
        }
        self
    }

    #[inline]
    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of_triangle(self.corners)
    }

    /// Whether the triangle has area, exactly.
    pub(super) fn has_area(&self) -> bool {
        projection_axis(self.corners).is_some()
    }

    /// Whether two triangles meet elsewhere than in what they share by vertex number, exactly.
    pub(super) fn meets(&self, other: &PatchTriangle) -> bool {
        meeting_point(self.vertices, self.corners, other.vertices, other.corners).is_some()
    }

    /// Returns the number of a vertex within the triangle, 0 to 2.
    pub(super) fn corner_of(&self, vertex: u32) -> Option<usize> {
        self.vertices.iter().position(|&v| v == vertex)
    }
}

/// The edge between two triangles, seen from the first: it runs from `a` to `b` there.
#[derive(Clone, Copy, Debug)]
pub struct PatchEdge {
    /// The numbers of the two triangles in the patch.
    pub(super) triangles: [usize; 2],
    /// The start of the edge: its number and position.
    pub a: (u32, [f64; 3]),
    /// The end of the edge.
    pub b: (u32, [f64; 3]),
    /// The vertex opposite to the edge in the first triangle.
    pub c: (u32, [f64; 3]),
    /// The vertex opposite to the edge in the second triangle.
    pub d: (u32, [f64; 3]),
}
