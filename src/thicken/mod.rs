//! Thickening: from an open surface patch to the solid on one side of it (\[WC13\], Wang and Chen 2013).
//!
//! ```text
//!  patch -> hierarchy -> nodes -> crossings -> contour, without its lid -> ribbons to the patch -> exact tests -> mesh
//! ```
//!
//! Promised: the result is closed, 2-manifold, consistently oriented and free of self-intersections, on the
//! coordinates of the chosen [`Precision`](crate::contour::Precision), and every triangle of the patch is in it. Where
//! that cannot be had, the run fails and says where; docs/thicken.md has the argument.

mod boundary;
mod check;
mod closed;
mod crossings;
mod curve;
mod nodes;
mod open_mesh;
mod ribbon;
mod settings;
mod solid;
mod statistics;
mod stitch;
#[cfg(test)]
mod tests;
mod unsuitable;

pub use settings::{Side, ThickenSettings};
pub use statistics::{ThickenStatistics, ThickenTimes, TriangleCounts};
pub use unsuitable::{Obstacle, PatchError, ThickenError};

use crate::distance::SignedDistance;
use crate::error::Error;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::offset::{Length, OffsetSettings, VoxelSize, check_memory};
use crate::run::{Phase, RunSettings};
use boundary::Boundary;
use nodes::Nodes;
use open_mesh::OpenMesh;
use solid::Solid;
use std::time::Instant;
use stitch::Reach;
use unsuitable::Blocked;

/// What [`thicken`] returns.
#[derive(Debug)]
pub struct ThickenResult {
    /// The solid's boundary. Its first triangles are those of the patch, in their order.
    pub mesh: TriMesh,
    /// What happened on the way.
    pub statistics: ThickenStatistics,
}

/// Depth of the lid in voxels. Deeper, and less is left of a thin solid; less deep, and the strip between the patch and
/// the section gets so narrow that a patch that is bent within a voxel pierces it.
const LID: f64 = 0.5;

/// Radius in voxels of the rods that join parts of S which touch in a vertex. A rod must hold nodes at each height, and the
/// rim around it must stay apart from the vertex; much thicker, and it shows.
const ROD: f64 = 1.5;

/// Nodes of the band beyond the shell, in voxels: an edge that crosses the shell ends at most one beyond it.
const BEYOND: f64 = 1.01;

/// The solid of the given thickness on one side of `patch` (\[WC13\] Definition 2).
///
/// # Errors
/// - [`Error::Thicken`]: settings that make no sense; a patch that is empty, not oriented, not 2-manifold or that
///   intersects itself; a place that no lattice was fine enough for.
/// - [`Error::Memory`]: the lattice would not fit.
/// - [`Error::Contour`], [`Error::TooManyEdges`]: the lattice is too fine for the precision or the indices.
/// - [`Error::Cancelled`].
pub fn thicken(
    patch: &TriMesh,
    settings: &ThickenSettings,
    run: &RunSettings,
) -> Result<ThickenResult, Error> {
    settings.validate()?;
    if patch.triangles.is_empty() {
        return Err(ThickenError::from(PatchError::NoTriangles).into());
    }
    let mut resolved = settings.resolve(patch)?;
    let started = Instant::now();
    let patch = as_written(patch, settings);
    let topology = run.install(|| Topology::new(&patch));
    let boundary = Boundary::new(&patch, &topology).map_err(ThickenError::from)?;
    run.install(|| check::check_patch(&patch, run))?.map_err(ThickenError::from)?;
    if boundary.is_empty() && settings.map.is_none() {
        return closed::shell(patch, &resolved, settings, run);
    }
    let distance = {
        let _phase = run.phase(Phase::Hierarchy, 0);
        run.install(|| SignedDistance::new(&patch, &topology))
    };
    run.check()?;
    let mut times = ThickenTimes { hierarchy: started.elapsed().as_secs_f64(), ..ThickenTimes::default() };
    let work = Work { patch: &patch, boundary: &boundary, distance: &distance, settings, run };
    work.check_memory(resolved.thickness, resolved.voxel)?;
    for halvings in 0.. {
        match work.on_lattice(resolved.thickness, resolved.voxel, &mut times)? {
            Ok(mesh) => {
                let kept = patch.triangles.len();
                let triangles =
                    TriangleCounts { kept: kept as u64, split: 0, new: (mesh.triangles.len() - kept) as u64 };
                let statistics = ThickenStatistics {
                    thickness: resolved.thickness,
                    voxel: resolved.voxel,
                    halvings,
                    times,
                    triangles,
                };
                return Ok(ThickenResult { mesh, statistics });
            }
            Err(_)
                if halvings < settings.halvings
                    && work.check_memory(resolved.thickness, 0.5 * resolved.voxel).is_ok() =>
            {
                resolved.voxel *= 0.5;
            }
            Err(Blocked { obstacle, at }) => {
                return Err(ThickenError::Obstacle { obstacle, at, voxel: resolved.voxel }.into());
            }
        }
    }
    unreachable!("halvings end")
}

/// The patch on the coordinates that will be written, with the solid on its negative side.
fn as_written(patch: &TriMesh, settings: &ThickenSettings) -> TriMesh {
    let vertices = patch.vertices.iter().map(|v| v.map(|x| settings.precision.round(x))).collect();
    let triangles = match settings.side {
        Side::Inner => patch.triangles.clone(),
        Side::Outer => patch.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    };
    TriMesh { vertices, triangles }
}

/// What stays the same on all lattices.
struct Work<'a> {
    patch: &'a TriMesh,
    boundary: &'a Boundary,
    distance: &'a SignedDistance<'a>,
    settings: &'a ThickenSettings,
    run: &'a RunSettings,
}

impl Work<'_> {
    /// Checks that a lattice fits into the memory that the settings allow.
    fn check_memory(&self, thickness: f64, voxel: f64) -> Result<(), Error> {
        // The band lies around the patch, and reaches as far as the shell.
        let band = OffsetSettings {
            distance: Length::Units(0.0),
            voxel: VoxelSize::Units(voxel),
            half_width: thickness / voxel + BEYOND,
            max_memory: self.settings.max_memory,
            ..OffsetSettings::default()
        };
        check_memory(self.patch, &band)
    }

    /// The solid on one lattice.
    fn on_lattice(
        &self,
        thickness: f64,
        voxel: f64,
        times: &mut ThickenTimes,
    ) -> Result<Result<TriMesh, Blocked>, Error> {
        let Work { patch, boundary, distance, settings, run } = *self;
        let lattice = Lattice { voxel };
        let started = Instant::now();
        let nodes = Nodes::new(distance, lattice, thickness + BEYOND * voxel, run)?;
        let lid = LID * voxel;
        let map = settings.map.as_deref();
        let solid =
            Solid { distance, boundary, thickness, map, lid, rod: ROD * voxel, lists: Some(&nodes.lists) };
        let (signs, triangles) = nodes.classify(&solid, lattice, run);
        times.nodes += started.elapsed().as_secs_f64();

        let started = Instant::now();
        let found = crossings::crossings(&solid, lattice, &signs, &triangles, run)?;
        let open = OpenMesh::new(&signs, &found, lattice, settings.precision, run)?;
        times.faces += started.elapsed().as_secs_f64();

        let started = Instant::now();
        let reach = Reach { across: 1.5 * thickness, along: 4.0 * voxel };
        let stitched = run.install(|| stitch::stitch(patch, boundary, open, reach, run))?;
        times.boundary += started.elapsed().as_secs_f64();
        Ok(stitched)
    }
}
