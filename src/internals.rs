//! The engine's rooms, for the program, benches and tests: no part of the library's promises.

use crate::band::BandSettings;
use crate::mesh::TriMesh;
use crate::offset::{OffsetSettings, SettingsError};

/// Returns the settings in model units for `mesh`.
///
/// # Errors
/// The first setting that makes no sense, or not for this mesh.
pub fn band_settings(settings: &OffsetSettings, mesh: &TriMesh) -> Result<BandSettings, SettingsError> {
    settings.in_model_units(mesh)
}
