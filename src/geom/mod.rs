//! Small geometry: exact predicates, symmetric 3 x 3 matrices.

pub mod predicates;
pub mod sym3;
