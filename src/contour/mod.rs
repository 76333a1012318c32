//! Dual contouring without intersections (\[LW11\] section VI, extended).
//!
//! Input is a sign for every node and a crossing for every grid edge with a sign change. Whatever they
//! are, the output is
//!
//! * closed and consistently oriented, counter-clockwise seen from outside,
//! * 2-manifold: two triangles at every edge, one fan at every vertex,
//! * free of intersecting, touching and degenerate triangles,
//!
//! exactly, for the coordinates as they are returned, which are those that a file of the chosen
//! [`Precision`] can hold. It is void when the mesh is moved, scaled or rounded further afterwards.
//! `tests` prove the promise on random lattices with the exact audit of [`verify`](crate::verify), thousands of them
//! when `EXOCARP_HEAVY=1` is set; docs/contouring.md has the argument, and which test stands for which step.
//!
//! Where the surface can be asked for more than its crossings (a [`Surface`]), vertices are placed on its creases
//! and corners, also outside of their cells, and the mesh can be refined to a tolerance. Nothing of the promise
//! depends on what the surface answers.
//!
//! The way, a file for each step:
//!
//! | file | what |
//! |---|---|
//! | `rounded_lattice` | the lattice rounded to the output's precision, before any decision |
//! | `cell`, `sheets` | the cube, and its 256 masks: pairs on faces, sheets, caps and their walls |
//! | `numbering` | active cells and their vertices, numbered by ranks in bit masks |
//! | `cells`, `leaf_crossings`, `leaf_vertices` | all cells, leaf by leaf, with the crossings of their edges (`beside`: what of them is a neighbour's) |
//! | `smooth` | the vertices of cells that see one smooth side, several at a time |
//! | `qef`, `region`, `vertex`, `vertex_set` | the vertex of any other sheet within its cell and its walls |
//! | `surface`, `planes`, `feature`, `features` | the surface's creases and corners: what a cell sees of them, where they are, remembered |
//! | `face_vertex` | vertices on faces where a connection would get in another sheet's way |
//! | `leaf_cells`, `edge_polygon` | the cells and the polygon around each crossed edge |
//! | `envelope`, `polygonize` | convex/concave analysis, and the triangles around an edge |
//! | `output`, `slots` | all polygons, collected to a mesh (`pieces`: what of it is moved) |
//! | `order` | the finished mesh leaf by leaf, and the part that a slab owns |
//! | `patch`, `editor`, `rounds` | changes of the finished mesh: the exact test, which to try, leaf by leaf |
//! | `recover`, `refine` | vertices to places outside of their cells; the mesh to a tolerance |
//! | `polygon_edges`, `cut_times` | the test that this analysis replaces, and the time of both |
//!
//! Why it holds: inside a cell lie the cones from its vertices over the triangles that crossed edges span with
//! the points where connections pass the cell's faces. On a face these triangles do not overlap, walls
//! separate the cones of different sheets, and a disc of good triangles stays in its edge's tetrahedra.

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
pub use error::{ContourError, TooManyVertices};
pub use implicit_surface::{Creases, ImplicitSurface, SurfaceSample};
pub use optimize::MAX_TRIANGLE_REACH;
pub use polygon::{CutTimes, cut_times};
pub use settings::{ContourSettings, CutMethod};
pub(crate) use slab::contour_by_edge;
pub use slab::{SlabContour, UnorderedContour, contour, contour_slab, halo};
pub use statistics::ContourStatistics;

#[cfg(test)]
mod tests;
