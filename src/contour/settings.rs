//! Settings of the contour.

use crate::lattice::Slab;
use crate::quantity::Precision;

/// Settings of a contour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourSettings {
    /// The coordinates of the result.
    pub precision: Precision,
    /// How the triangles around an edge are chosen.
    pub cut: CutMethod,
    /// Refine the mesh until it is within this many voxels of the surface; `None` leaves it as the lattice gives it.
    pub tolerance: Option<f64>,
    /// The part of the lattice that is counted.
    pub slab: Slab,
    /// The largest index, in size, of all nodes, where `signs` are not all; `None` if they are.
    pub extent: Option<u32>,
}

/// How it is decided which triangles stay in the envelope of a grid edge. Either way the mesh is closed,
/// 2-manifold and free of intersections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CutMethod {
    /// By convex/concave analysis (\[LW11\] section VI).
    #[default]
    ConvexConcave,
    /// By segment-triangle intersections (Ju and Udeshi 2006): slower, and never with fewer triangles. It is
    /// there to be measured against.
    PolygonEdges,
}
