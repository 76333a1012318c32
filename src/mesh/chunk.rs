//! A part of a mesh that comes in parts.

use super::TriMesh;
use std::ops::Range;

/// A part of a mesh that is made part by part.
///
/// Chunks follow one another: the vertices of the first, then those of the second, and so on, are
/// the vertices of the whole, and so are the triangles. A triangle may have vertices of the chunks
/// before and after its own; those of the chunk after come with that.
#[derive(Debug)]
pub struct MeshChunk<'a> {
    mesh: &'a TriMesh,
    own_vertices: Range<usize>,
    own_triangles: Range<usize>,
    first_vertex: u64,
}

impl<'a> MeshChunk<'a> {
    /// Returns the vertices and triangles of `mesh` with these numbers. The first of the vertices
    /// has the number `first_vertex` in the whole, whose other vertices are around them in `mesh`.
    pub(crate) fn new(
        mesh: &'a TriMesh,
        own_vertices: Range<usize>,
        own_triangles: Range<usize>,
        first_vertex: u64,
    ) -> MeshChunk<'a> {
        MeshChunk { mesh, own_vertices, own_triangles, first_vertex }
    }

    /// Returns a chunk without vertices and triangles.
    pub fn empty() -> MeshChunk<'static> {
        static NOTHING: TriMesh = TriMesh { vertices: Vec::new(), triangles: Vec::new() };
        MeshChunk::new(&NOTHING, 0..0, 0..0, 0)
    }

    /// Returns the number that the first vertex of the chunk has in the whole mesh, which is the
    /// number of vertices of the chunks before. For the chunk of a tile it is a number that leaves
    /// room for the vertices of the tile before.
    pub fn first_vertex(&self) -> u64 {
        self.first_vertex
    }

    /// Returns the positions of the chunk's vertices, in model units.
    pub fn vertices(&self) -> &'a [[f64; 3]] {
        &self.mesh.vertices[self.own_vertices.clone()]
    }

    /// Returns the number of the chunk's triangles.
    pub fn triangle_count(&self) -> usize {
        self.own_triangles.len()
    }

    /// Returns the chunk's triangles, as numbers of vertices in the whole mesh.
    pub fn triangles(&self) -> impl Iterator<Item = [u64; 3]> + use<'a> {
        // The vertices around the chunk's own lie beside them in the whole as they do here.
        let (first, start) = (self.first_vertex, self.own_vertices.start as u64);
        let number = move |v: u32| first.wrapping_add(u64::from(v)).wrapping_sub(start);
        self.local_triangles().iter().map(move |t| t.map(number))
    }

    /// Returns the corners of the chunk's triangles, in model units.
    pub fn corners(&self) -> impl Iterator<Item = [[f64; 3]; 3]> + use<'a> {
        let mesh = self.mesh;
        self.own_triangles.clone().map(move |t| mesh.corners(t))
    }

    /// Returns the chunk's triangles, as numbers of vertices in the mesh that it is a part of.
    pub(crate) fn local_triangles(&self) -> &'a [[u32; 3]] {
        &self.mesh.triangles[self.own_triangles.clone()]
    }

    /// Returns the numbers of the chunk's vertices in the mesh that it is a part of.
    pub(crate) fn local_vertices(&self) -> Range<usize> {
        self.own_vertices.clone()
    }

    /// Returns the mesh that the chunk is a part of.
    pub(crate) fn around(&self) -> &'a TriMesh {
        self.mesh
    }
}
