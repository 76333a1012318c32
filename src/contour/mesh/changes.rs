//! The changes that a patch makes to the mesh.

/// The changes of a patch, by numbers of the mesh.
///
/// Vertices and triangles that the patch added are numbered on from [`NEW_VERTEX`] and
/// [`NEW_TRIANGLE`].
#[derive(Debug, Default)]
pub struct Changes {
    /// New positions of vertices. Of several for one vertex the last one counts.
    pub moved: Vec<(u32, [f64; 3])>,
    /// The vertices of changed triangles, or of triangles with moved vertices; `None` for removed
    /// triangles. Of several for one triangle the last one counts.
    pub triangles: Vec<(usize, Option<[u32; 3]>)>,
    /// The number of added vertices.
    pub new_vertices: u32,
    /// The number of added triangles.
    pub new_triangles: usize,
    /// The removed vertices.
    pub removed_vertices: Vec<u32>,
}

/// The number of the first vertex that a patch adds.
pub const NEW_VERTEX: u32 = 1 << 31;

/// The number of the first triangle that a patch adds.
pub const NEW_TRIANGLE: usize = 1 << 40;
