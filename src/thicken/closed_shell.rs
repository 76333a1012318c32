//! The solid of a closed patch: the shell between the patch and its offset on one side.

use super::settings::ModelUnits;
use super::{ThickenError, ThickenSettings, ThickenTimes};
use crate::mesh::TriMesh;
use crate::mesh::measure::signed_volume;
use crate::offset::{EngineTimes, OffsetError, OffsetSettings, offset};
use crate::quantity::{Length, VoxelSize};
use crate::run::RunSettings;

/// Joins the patch and its offset by the thickness, in opposite orientation (\[WC13\] Figure 13).
///
/// A patch that is too small for a cavity stays as it is: the solid fills it.
pub(super) fn closed_shell(
    patch: &TriMesh,
    at: ModelUnits,
    settings: &ThickenSettings,
    times: &mut ThickenTimes,
    run: &RunSettings,
) -> Result<TriMesh, ThickenError> {
    let ModelUnits { thickness, voxel } = at;
    // The solid is on the negative side: within the patch, or around it.
    let is_around = signed_volume(patch) < 0.0;
    let offset_settings = |distance| OffsetSettings {
        distance: Length::Units(distance),
        voxel: VoxelSize::Units(voxel),
        precision: settings.precision,
        max_memory: settings.max_memory,
        ..OffsetSettings::default()
    };
    let made = if is_around {
        offset(&reversed(patch.clone()), &offset_settings(thickness), run)
    } else {
        offset(patch, &offset_settings(-thickness), run)
    };
    let other = match made {
        Ok(made) => {
            let EngineTimes { hierarchy, band, edges, contour, .. } = made.statistics.times;
            times.hierarchy += hierarchy;
            times.nodes += band;
            times.faces += edges + contour;
            if is_around { made.mesh } else { reversed(made.mesh) }
        }
        Err(OffsetError::Empty(_)) if !is_around => TriMesh::default(),
        Err(error) => return Err(error.into()),
    };
    let mut mesh = patch.clone();
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(other.vertices);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    Ok(mesh)
}

/// Turns the normals of a surface to its other side.
fn reversed(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}
