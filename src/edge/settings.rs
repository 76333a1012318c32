//! Which surface the edges are intersected with, and by which method.

use super::hybrid::TOLERANCE;
use crate::lattice::{Lattice, Slab};

/// How the intersection of an edge is found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RootMethod {
    /// In closed form on the triangle that is closest where the last one had its root.
    #[default]
    TriangleIteration,
    /// The method of \[LW11\]: in closed form where both ends share a triangle, with halving between attempts.
    Hybrid,
    /// By halving only, until abs(phi) is at most `tolerance` voxels: the measure that Table V of \[LW11\]
    /// holds against the hybrid method.
    Bisection {
        /// In voxels, positive.
        tolerance: f64,
    },
}

impl RootMethod {
    /// Bisection to the tolerance of the hybrid method.
    pub const PLAIN_BISECTION: RootMethod = RootMethod::Bisection { tolerance: TOLERANCE };
}

/// Which surface to intersect with, on which lattice, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeSettings {
    /// The lattice.
    pub lattice: Lattice,
    /// The offset distance r in model units.
    pub r: f64,
    /// The way to the roots.
    pub method: RootMethod,
    /// The part of the lattice whose edges are counted; all are intersected.
    pub slab: Slab,
}
