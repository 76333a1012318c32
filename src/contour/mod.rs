//! Dual contouring without intersections (\[LW11\] section VI, extended).
//!
//! The input is a sign for every node, and a crossing for every grid edge with a sign change.
//! Whatever they are, the output is
//!
//! * closed and consistently oriented, counter-clockwise seen from outside,
//! * 2-manifold: two triangles at every edge, one fan at every vertex,
//! * free of intersecting, touching and degenerate triangles,
//!
//! exactly, for the coordinates as they are returned. A file of the chosen [`Precision`] can hold
//! these coordinates. The promise is void when the mesh is moved, scaled or rounded further
//! afterwards.
//!
//! `tests` prove the promise on random lattices with the exact audit of [`verify`](crate::verify),
//! thousands of them when `EXOCARP_HEAVY=1` is set. docs/contouring.md has the argument, and the
//! test that stands for each step.
//!
//! With an [`ImplicitSurface`] vertices are placed on creases and corners, also outside of their
//! cells, and the mesh can be refined to a tolerance. Nothing of the promise depends on the samples
//! of the surface.
//!
//! `slab` is the row of steps. The folders, in the order in which they run:
//!
//! | folder | contents |
//! |---|---|
//! | `cell` | the cube; the case table of sheets, caps and walls; the numbers of active cells |
//! | `feature` | creases and corners: tangent planes that a cell sees, the point in which they meet, vertices that stand for them |
//! | `vertex` | the vertex of each sheet, within its cell and its walls; vertices on faces |
//! | `polygon` | the polygon around each crossed edge, split into triangles by convex/concave analysis |
//! | `mesh` | the mesh by leaves: buffers, changes, the order in which it is handed out |
//! | `optimize` | edits of the finished mesh under an exact test: features recovered, tolerance kept |
//!
//! `rounded_lattice` comes before all of them: coordinates are rounded before anything is decided.
//!
//! The reason why it holds: inside a cell lie the cones from its vertices over the triangles that
//! crossed edges span with the points where connections pass the cell's faces. On a face these
//! triangles do not overlap, walls separate the cones of different sheets, and a disc of good
//! triangles stays in its edge's tetrahedra.

mod error;
mod implicit_surface;
mod rounded_lattice;
mod settings;
mod statistics;

mod cell;
mod feature;
mod vertex;
mod polygon;
mod mesh;
mod optimize;

mod slab;

pub use crate::quantity::Precision;
pub use error::ContourError;
pub use implicit_surface::{Creases, ImplicitSurface, SurfaceSample};
pub use optimize::MAX_TRIANGLE_REACH;
pub use polygon::{DiagonalTestTimes, time_diagonal_tests};
pub use settings::{ContourSettings, DiagonalTest};
pub(crate) use slab::contour_by_edge;
pub use slab::{SlabContour, UnorderedContour, contour, contour_slab, halo};
pub use statistics::ContourStatistics;

#[cfg(test)]
mod tests;
