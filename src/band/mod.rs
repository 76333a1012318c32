//! The narrow band around the offset surface (\[LW11\] section IV).

mod build;
mod leaf_from_candidates;
mod leaf_from_hierarchy;
mod count;
mod inside;
mod jumps;
mod layers;
mod leaf;
mod leaves;
mod lone_nodes;
pub(crate) mod narrow_band;
mod node_triangles;
mod policy;
mod ring;
mod signs;
#[cfg(test)]
mod tests;

pub use build::{
    BOXES_PER_BATCH, BandSettings, build, build_filtered, build_map, build_with_policy, grid_nodes,
};
pub use count::count_queries;
pub use inside::InsideBlocks;
pub use jumps::leaves_at_jumps;
pub use layers::{Layers, count_layers};
pub use leaves::{LeafBatch, inside_mask};
pub use lone_nodes::{LoneNodes, join_lone_nodes};
pub use node_triangles::{LeafTriangles, NearTriangles, NodeTriangles, PartTriangles};
pub use policy::{BlockCandidates, BlockState, LeafPolicy, SignedBand};
pub use signs::{LeafId, SignField};
