//! The creases and corners of the surface: what a cell sees of them, where they are, and which vertices stand for them.

mod feature_map;
mod locate;
mod tangent_planes;
mod vertex_set;

pub use feature_map::{Bend, FeatureVertex, Features, Sides};
pub use locate::{Asker, Feature, REACH, SPREAD, feature, feature_between, nearest};
pub use tangent_planes::{Normals, Samples};
pub use vertex_set::VertexSet;
