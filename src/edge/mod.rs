//! Intersections of grid edges with the offset surface ([LW11] section V).

mod crossings;

pub use crossings::{Crossing, Crossings, EdgeId, EdgeNumbers, TooManyEdges, bits};
