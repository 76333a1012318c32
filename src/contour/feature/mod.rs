//! The creases and corners of the surface: what a cell sees of them, and their positions.

mod crease_planes;
mod feature_map;
mod locate;
mod probe;
mod tangent_planes;
mod vertex_set;

pub use crease_planes::{CreasePlanes, CurvatureBound};
pub use feature_map::{FeatureMap, FeatureVertex};
pub use locate::{
    Feature, MAX_FEATURE_REACH, MIN_SPREAD, feature_between, locate_feature, project_to_surface,
};
pub use probe::SurfaceProbe;
pub use tangent_planes::{HermiteSamples, Normals};
pub use vertex_set::VertexSet;
