//! Counts of the filters' work (\[LW11\] Table IV).

use std::ops::AddAssign;

/// Distance computations by filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FilterStatistics {
    /// Nodes of the grid that encloses model and offset surface.
    pub nodes_total: u64,
    /// Queries at the centres of the bounding boxes.
    pub bounding_box_queries: u64,
    /// Bounding boxes that the signed distance filter rejected.
    pub signed_distance_rejected: u64,
    /// Octree queries after which the block was kept.
    pub octree_queries_valid: u64,
    /// Octree queries after which the block was rejected.
    pub octree_queries_invalid: u64,
    /// Queries at nodes.
    pub node_queries: u64,
    /// Nodes with abs(phi) <= h.
    pub valid_nodes: u64,
    /// Triangles in all candidate lists of blocks of 8^3, 4^3 and 2^3 nodes.
    pub lists: [u64; 3],
}

impl FilterStatistics {
    /// Returns all distance computations: at centres of boxes, at centres of octree blocks, at
    /// nodes.
    pub fn distance_computations(&self) -> u64 {
        self.bounding_box_queries
            + self.octree_queries_valid
            + self.octree_queries_invalid
            + self.node_queries
    }
}

impl AddAssign for FilterStatistics {
    fn add_assign(&mut self, o: Self) {
        self.nodes_total += o.nodes_total;
        self.bounding_box_queries += o.bounding_box_queries;
        self.signed_distance_rejected += o.signed_distance_rejected;
        self.octree_queries_valid += o.octree_queries_valid;
        self.octree_queries_invalid += o.octree_queries_invalid;
        self.node_queries += o.node_queries;
        self.valid_nodes += o.valid_nodes;
        for (own, other) in self.lists.iter_mut().zip(o.lists) {
            *own += other;
        }
    }
}
