//! The surface itself, where the contour may ask for more than its crossings with grid edges.

use glam::DVec3;

/// The kind of the creases of a surface, and so the way its distance runs near them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Creases {
    /// All creases are concave, as those of a grown offset: the distance is the least of the
    /// distances from the crease's planes.
    Concave,
    /// All creases are convex, as those of a shrunk offset: the distance is the largest of these.
    Convex,
    /// There are creases of either kind.
    Both,
}

/// The signed distance at a point, with its gradient.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSample {
    /// Signed distance in model units, negative inside.
    pub distance: f64,
    /// Unit gradient of the distance.
    pub gradient: DVec3,
    /// The number of the closest triangle.
    pub triangle: u32,
}

/// A surface given by its signed distance.
///
/// The surface consists of the surfaces of triangles: the offset surface of a mesh has a face for
/// each triangle, edge and vertex, and each belongs to a triangle.
pub trait ImplicitSurface: Sync {
    /// Returns the kind of the creases.
    fn creases(&self) -> Creases;

    /// Returns the largest curvature of the faces, in one over model units: away from concave
    /// creases, towards convex ones.
    fn curvature(&self) -> f64;

    /// Samples the distance at `p`.
    ///
    /// `hint` is a triangle near `p`, for speed only: [`Crossing::triangle`](crate::edge::Crossing)
    /// at first, then the triangle of the last sample near it.
    fn sample(&self, p: DVec3, hint: u32) -> SurfaceSample;

    /// Samples the distance at `p` from the surface of one triangle alone, continued beyond the
    /// creases in which it ends.
    fn sample_triangle(&self, p: DVec3, triangle: u32) -> SurfaceSample;
}
