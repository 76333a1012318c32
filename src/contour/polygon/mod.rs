//! The polygons around crossed grid edges, and their triangles.

mod assemble;
mod diagonal_test_times;
mod edge_polygon;
mod envelope;
mod ju_udeshi;
mod leaf_cells;
mod triangulate;

pub use assemble::{Triangulation, triangulate};
pub use diagonal_test_times::{DiagonalTestTimes, time_diagonal_tests};
