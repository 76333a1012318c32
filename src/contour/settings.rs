//! Settings of the contour.

use crate::lattice::Slab;
use crate::quantity::Precision;

/// Settings of a contour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourSettings {
    /// The precision of the result's coordinates.
    pub precision: Precision,
    /// The test for the diagonals of the polygons around grid edges.
    pub diagonal_test: DiagonalTest,
    /// The largest distance of the mesh from the surface, in voxels; `None` leaves the mesh as the
    /// lattice gives it.
    pub tolerance: Option<f64>,
    /// The part of the lattice that is counted.
    pub slab: Slab,
    /// The largest index, in size, of all nodes, where `signs` are not all; `None` if they are.
    pub extent: Option<u32>,
}

/// The test whether the triangles of a diagonal stay in the envelope of a grid edge.
///
/// With either test the mesh is closed, 2-manifold and free of intersections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DiagonalTest {
    /// By convex/concave analysis (\[LW11\] section VI).
    #[default]
    ConvexConcave,
    /// By segment-triangle intersections (Ju and Udeshi 2006): slower, and never with fewer
    /// triangles. It is there to be measured against.
    PolygonEdges,
}
