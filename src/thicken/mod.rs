//! Thickening: from an open surface patch to the solid on one side of it (\[WC13\], Wang and Chen 2013).
//!
//! ```text
//!  patch -> hierarchy -> nodes -> crossings -> contour, without its lid -> strips to the patch -> exact tests -> mesh
//! ```
//!
//! Promised: the result is closed, 2-manifold, consistently oriented and free of self-intersections, on the
//! coordinates of the chosen [`Precision`](crate::contour::Precision), and every triangle of the patch is in it. Where
//! that cannot be had, the run fails and says where; docs/thicken.md has the argument.

mod attempt;
mod closed_shell;
mod error;
mod finish;
mod memory_estimate;
mod patch;
mod settings;
mod solid;
mod statistics;
mod stitch;

pub use error::{Obstacle, PatchError, ThickenError};
pub use settings::{SectionNormals, Side, ThickenSettings};
pub use statistics::{ShapeCounts, ThickenStatistics, ThickenTimes, TriangleCounts};

use crate::error::Error;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;

use attempt::{Surface, Work};
use error::Blocked;
use finish::shape::Shaped;
use patch::boundary::Boundary;
use patch::holes::{Capped, Holes};
use patch::intersections;
use settings::Resolved;
use std::time::Instant;

/// What [`thicken`] returns.
#[derive(Debug)]
pub struct ThickenResult {
    /// The solid's boundary. Its first triangles are those of the patch, in their order.
    pub mesh: TriMesh,
    /// What happened on the way.
    pub statistics: ThickenStatistics,
}

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
    patch.check().map_err(PatchError::from).map_err(ThickenError::from)?;
    let resolved = settings.resolve(patch)?;
    let started = Instant::now();
    let patch = as_written(patch, settings);
    let topology = run.install(|| Topology::new(&patch));
    let (boundary, checked) = run.install(|| {
        rayon::join(|| Boundary::new(&patch, &topology), || intersections::check_patch(&patch, run))
    });
    let boundary = boundary.map_err(ThickenError::from)?;
    checked?.map_err(ThickenError::from)?;
    let holes = Holes::new(&patch, &topology, &boundary);
    let mut work = Work { settings, run, times: ThickenTimes::default(), shaped: Shaped::default() };
    work.times.hierarchy = started.elapsed().as_secs_f64();
    work.check_memory(&patch, &boundary, resolved)?;
    let (mut halvings, mut at) = (0, resolved);
    let mut closed = holes.unseen(at.voxel);
    let (mesh, capped) = loop {
        let Capped { mesh: surface, places } = run.install(|| holes.close(&closed, run))?;
        let known = Surface { topology: &topology, boundary: &boundary };
        // Without caps the surface is the patch.
        let known = places.is_empty().then_some(known);
        let Blocked { obstacle, at: place, edges } = match work.on_lattice(&surface, known, at)? {
            Ok(mesh) => break (mesh, places),
            Err(blocked) => blocked,
        };
        let before = closed.len();
        closed.extend(holes.in_the_way(&edges, at.voxel));
        if closed.len() > before {
            continue;
        }
        let finer = Resolved { voxel: 0.5 * at.voxel, ..at };
        if halvings == settings.halvings || work.check_memory(&patch, &boundary, finer).is_err() {
            return Err(ThickenError::Obstacle { obstacle, at: place, voxel: at.voxel }.into());
        }
        halvings += 1;
        at = finer;
        closed = holes.unseen(at.voxel);
    };
    let kept = patch.triangles.len() as u64;
    let triangles = TriangleCounts { kept, split: 0, new: mesh.triangles.len() as u64 - kept };
    let Resolved { thickness, voxel } = at;
    let Shaped { rounds, moves } = work.shaped;
    let shape = ShapeCounts { rounds, moves };
    let times = work.times;
    let statistics = ThickenStatistics { thickness, voxel, halvings, times, triangles, capped, shape };
    Ok(ThickenResult { mesh, statistics })
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
