//! Counts of edges by the way their intersection was found (\[LW11\] Table V).

use std::ops::AddAssign;

/// Subdivisions after which an analytic solution still counts as one, as in Table V.
pub const COUNTED_SUBDIVISIONS: usize = 6;

/// Edges by the way their intersection was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EdgeStatistics {
    /// Intersected grid edges.
    pub intersected: u64,
    /// Entry n: edges solved analytically after n attempts that failed; by the hybrid method, after
    /// n subdivisions; by plain bisection, edges solved by n halvings.
    pub by_subdivision: [u64; COUNTED_SUBDIVISIONS + 1],
    /// Edges that bisection finished; by plain bisection, those that took more than six halvings.
    pub bisected: u64,
    /// Closest-point queries for all of them.
    pub queries: u64,
    /// Edges along which the sign of the distance jumps without a root, which only happens when the
    /// input is not closed: the surface is closed there.
    pub sign_jumps: u64,
}

impl AddAssign for EdgeStatistics {
    fn add_assign(&mut self, o: Self) {
        self.intersected += o.intersected;
        for (count, more) in self.by_subdivision.iter_mut().zip(o.by_subdivision) {
            *count += more;
        }
        self.bisected += o.bisected;
        self.queries += o.queries;
        self.sign_jumps += o.sign_jumps;
    }
}
