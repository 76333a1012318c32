//! Settings of the edge solver: the surface, the lattice and the method.

use super::hybrid::ROOT_TOLERANCE;
use crate::lattice::{Lattice, Slab};

/// The method that finds the intersection of an edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RootMethod {
    /// Fixed-point iteration: the closed form on one triangle, then on the triangle that is closest
    /// to its root, until both are one.
    #[default]
    TriangleIteration,
    /// The method of \[LW11\]: the closed form where both ends share a triangle, halving between
    /// attempts.
    Hybrid,
    /// Halving only, until abs(phi) is at most `tolerance` voxels: the measure that Table V of
    /// \[LW11\] holds against the hybrid method.
    Bisection {
        /// In voxels, positive.
        tolerance: f64,
    },
}

impl RootMethod {
    /// Bisection to the tolerance of the hybrid method.
    pub const PLAIN_BISECTION: RootMethod = RootMethod::Bisection { tolerance: ROOT_TOLERANCE };
}

/// The surface to intersect with, the lattice, and the method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSettings {
    /// The lattice.
    pub lattice: Lattice,
    /// The offset distance r in model units.
    pub r: f64,
    /// The method that finds the roots.
    pub method: RootMethod,
    /// The part of the lattice whose edges are counted; all are intersected.
    pub slab: Slab,
}
