//! The outcome of a step that a lattice may be too coarse for.

use super::Obstacle;

/// The outcome of a step on one lattice.
#[derive(Clone, Debug)]
pub(super) enum Outcome<T> {
    /// The step's result.
    Done(T),
    /// The lattice is too coarse for a place of the patch.
    Blocked(Blockage),
}

/// A place of the patch that a lattice is too coarse for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Blockage {
    /// The obstacle there.
    pub obstacle: Obstacle,
    /// A point near the obstacle.
    pub at: [f64; 3],
    /// A boundary edge of each loop that is in the way, there and elsewhere.
    pub edges: Vec<[u32; 2]>,
}
