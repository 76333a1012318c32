//! A closed patch: the shell between it and its offset on one side.

use super::settings::Resolved;
use super::{ThickenResult, ThickenSettings, ThickenStatistics, ThickenTimes, TriangleCounts};
use crate::error::Error;
use crate::mesh::TriMesh;
use crate::mesh::measure::signed_volume;
use crate::offset::{Length, OffsetSettings, VoxelSize, offset};
use crate::run::RunSettings;

/// The patch, and its offset by the thickness with the opposite orientation (\[WC13\] Figure 13). A patch that is too small
/// for a cavity stays as it is: the solid fills it.
pub(super) fn shell(
    patch: TriMesh,
    resolved: &Resolved,
    settings: &ThickenSettings,
    run: &RunSettings,
) -> Result<ThickenResult, Error> {
    let Resolved { thickness, voxel } = *resolved;
    // The solid is on the negative side: within the patch, or around it.
    let is_around = signed_volume(&patch) < 0.0;
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
        offset(&patch, &offset_settings(-thickness), run)
    };
    let mut statistics = ThickenStatistics { thickness, voxel, ..ThickenStatistics::default() };
    let other = match made {
        Ok(made) => {
            let times = made.statistics.times;
            statistics.times = ThickenTimes {
                hierarchy: times.hierarchy,
                nodes: times.band,
                faces: times.edges + times.contour,
                ..ThickenTimes::default()
            };
            if is_around { made.mesh } else { reversed(made.mesh) }
        }
        Err(Error::Empty(_)) if !is_around => TriMesh::default(),
        Err(error) => return Err(error),
    };
    statistics.triangles =
        TriangleCounts { kept: patch.triangles.len() as u64, split: 0, new: other.triangles.len() as u64 };
    let mut mesh = patch;
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(other.vertices);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    Ok(ThickenResult { mesh, statistics })
}

/// The same surface with its normals on the other side.
fn reversed(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}
