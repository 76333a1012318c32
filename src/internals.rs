//! The engine's rooms, for the program, benches and tests: no part of the library's promises.

use crate::mesh::TriMesh;
use crate::offset::{OffsetSettings, SettingsError};
use band::BandSettings;

/// Makes a room of the engine visible under its own name.
macro_rules! rooms {
    ($($room:ident),+ $(,)?) => {$(
        #[doc = concat!("The room `", stringify!($room), "`.")]
        pub mod $room {
            pub use crate::$room::*;
        }
    )+};
}

rooms!(
    band, candidates, contour, distance, edge, filter, geom, lattice, mesh, offset, quantity, run, ssvh,
    subvoxel, system, thicken,
);

#[cfg(feature = "cli")]
rooms!(compare, paper);

/// Files of meshes: the parts that only the program and tests use.
pub mod io {
    pub use crate::io::atomic::{directory_of, keep_permissions, resolved};
    pub use crate::io::error::UnknownFormat;
    pub use crate::io::load::{load, vertex_property};
    pub use crate::io::loaded::Passed;
}

/// OpenVDB: the parts that only the program, comparisons and tests use.
#[cfg(feature = "openvdb")]
pub mod vdb {
    pub use crate::vdb::file::{open_band, open_closest, open_surface, write};
    pub use crate::vdb::info::{GridInfo, info};
    #[cfg(feature = "cli")]
    pub use crate::vdb::openvdb_tools::{BandWidths, Polygons, Scheme, VdbLevelSet};
    pub use crate::vdb::tiles::write_tile;
}

/// The judge's parts.
pub mod verify {
    pub use crate::verify::judge::{creases, distance_error, intersections, missing, topology};
    pub use crate::verify::report::{
        Histogram, IntersectingPair, Judged, ReportedLength, Statistics, Thickness,
    };
    pub use crate::verify::settings::{DEFAULT_SAMPLES, DEFAULT_SEED, MAX_SAMPLES};
}

/// Returns the settings in model units for `mesh`.
///
/// # Errors
/// The first setting that makes no sense, or not for this mesh.
pub fn band_settings(settings: &OffsetSettings, mesh: &TriMesh) -> Result<BandSettings, SettingsError> {
    settings.in_model_units(mesh)
}
