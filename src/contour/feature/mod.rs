//! The creases and corners of the surface: tangent planes that a cell sees, and the point in which
//! they meet.
//!
//! A *smooth face*, or face for short, is a part of the surface between creases. Two faces meet in
//! a crease, three or more in a corner. Cells have faces, too; in this folder the word is never
//! theirs.

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
