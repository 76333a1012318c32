//! What a patch changed.

type Point = [f64; 3];

/// What a patch changed, by numbers of the mesh. Vertices and triangles that it added are numbered on from
/// [`NEW_VERTEX`] and [`NEW_TRIANGLE`].
#[derive(Debug, Default)]
pub struct Changes {
    /// New positions of vertices; the last one counts.
    pub moved: Vec<(u32, Point)>,
    /// The vertices of triangles that have others, or moved ones; `None` for those that are gone. The last ones count.
    pub triangles: Vec<(usize, Option<[u32; 3]>)>,
    /// Vertices added.
    pub new_vertices: u32,
    /// Triangles added.
    pub new_triangles: usize,
    /// Vertices that are gone.
    pub gone_vertices: Vec<u32>,
}

/// The number of the first vertex that a patch adds.
pub const NEW_VERTEX: u32 = 1 << 31;

/// The number of the first triangle that a patch adds.
pub const NEW_TRIANGLE: usize = 1 << 40;
