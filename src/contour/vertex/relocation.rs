//! Vertices that belong elsewhere.

/// A vertex that belongs elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Relocation {
    /// The number of the vertex.
    pub vertex: u32,
    /// The position to move to, rounded; `None` when it is looked for on the surface, which is far
    /// from the vertex or from the triangles around it.
    pub target: Option<[f64; 3]>,
}
