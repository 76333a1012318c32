//! Why an offset cannot be made, told before the work starts where that is possible.

use super::settings::{OpenInput, SettingsError};
use crate::band::BandSettings;
use crate::contour::ContourError;
use crate::distance::{SignedDistance, largest_depth};
use crate::lattice::LatticeError;
use crate::mesh::{MeshError, Topology, TriMesh};
use crate::run::{Bytes, Cancelled, RunSettings};
#[cfg(feature = "openvdb")]
use crate::vdb::VdbError;

/// Why an offset, its band or a part of it could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OffsetError {
    /// A setting makes no sense, by itself or for this mesh.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The mesh is not the boundary of a solid.
    #[error(transparent)]
    Input(#[from] InputError),
    /// Nothing is left at this distance, or nothing that the lattice sees.
    #[error(transparent)]
    Empty(#[from] EmptyResult),
    /// The work would not fit into memory.
    #[error(transparent)]
    Memory(#[from] MemoryError),
    /// The lattice is too fine for the indices or the precision.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// OpenVDB could not hold the band.
    #[cfg(feature = "openvdb")]
    #[error(transparent)]
    Vdb(VdbError),
    /// The receiver of a streamed mesh failed.
    #[error(transparent)]
    Sink(Box<dyn std::error::Error + Send + Sync>),
    /// The run was cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for OffsetError {
    fn from(Cancelled: Cancelled) -> Self {
        OffsetError::Cancelled
    }
}

impl From<ContourError> for OffsetError {
    fn from(error: ContourError) -> Self {
        match error {
            ContourError::Cancelled(cancelled) => cancelled.into(),
            ContourError::Lattice(error) => error.into(),
        }
    }
}

#[cfg(feature = "openvdb")]
impl From<VdbError> for OffsetError {
    fn from(error: VdbError) -> Self {
        match error {
            VdbError::Cancelled => OffsetError::Cancelled,
            other => OffsetError::Vdb(other),
        }
    }
}

/// The work would not fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "voxel size {voxel} needs about {} of memory, and {} are allowed; the smallest voxel size that fits is \
     about {smallest_voxel:.3e}",
    Bytes(*.needed), Bytes(*.allowed)
)]
pub struct MemoryError {
    /// The voxel size asked for, in model units.
    pub voxel: f64,
    /// The estimate, in bytes.
    pub needed: u64,
    /// The limit, in bytes.
    pub allowed: u64,
    /// The smallest voxel size that would fit, in model units.
    pub smallest_voxel: f64,
}

/// The input is not the boundary of a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InputError {
    /// There is no triangle.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A vertex or a triangle cannot be worked with.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Each triangle has a twin that faces the other way.
    #[error(
        "each of the {triangles} triangles lies on another one that faces the other way, so nothing is inside; \
         keep one of the two sides, and thicken that"
    )]
    Doubled {
        /// The number of triangles.
        triangles: usize,
    },
    /// Edges with a single triangle.
    #[error(
        "the mesh is not closed: {count} boundary edges, the first from ({:.6}, {:.6}, {:.6}) to ({:.6}, \
         {:.6}, {:.6}); close its holes",
        .first[0][0], .first[0][1], .first[0][2], .first[1][0], .first[1][1], .first[1][2]
    )]
    Open {
        /// The number of boundary edges.
        count: usize,
        /// The ends of the first one.
        first: [[f64; 3]; 2],
    },
    /// Edges whose triangles do not agree on the outside.
    #[error(
        "the mesh is not consistently oriented: {count} edges whose triangles run the same way, the first \
         from ({:.6}, {:.6}, {:.6}) to ({:.6}, {:.6}, {:.6}); reorient its triangles",
        .first[0][0], .first[0][1], .first[0][2], .first[1][0], .first[1][1], .first[1][2]
    )]
    Misoriented {
        /// The number of such edges.
        count: usize,
        /// The ends of the first one.
        first: [[f64; 3]; 2],
    },
}

/// Checks what must be right before the topology is looked at.
pub(super) fn check_mesh(mesh: &TriMesh) -> Result<(), InputError> {
    if mesh.triangles.is_empty() {
        return Err(InputError::NoTriangles);
    }
    Ok(mesh.check()?)
}

/// Checks that the mesh is the boundary of a solid, where the sign needs that.
pub(super) fn check_input(
    mesh: &TriMesh,
    topology: &Topology,
    open_input: OpenInput,
) -> Result<(), InputError> {
    if topology.defects().non_manifold_edges > 0 && is_doubled(mesh) {
        return Err(InputError::Doubled { triangles: mesh.triangles.len() });
    }
    if open_input == OpenInput::Accept {
        return Ok(());
    }
    let ends = |edge: [u32; 2]| edge.map(|v| mesh.vertices[v as usize]);
    let defects = topology.defects();
    if let Some(first) = defects.first_boundary {
        return Err(InputError::Open { count: defects.boundary_edges, first: ends(first) });
    }
    if let Some(first) = defects.first_misoriented {
        return Err(InputError::Misoriented { count: defects.misoriented_edges, first: ends(first) });
    }
    Ok(())
}

/// Whether each triangle has a twin that faces the other way: the two sides of a sheet, as chairs
/// and leaves come.
fn is_doubled(mesh: &TriMesh) -> bool {
    // From its lowest vertex on, which leaves the two ways round apart.
    let turned = |&[a, b, c]: &[u32; 3]| match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    };
    let mut there: Vec<[u32; 3]> = mesh.triangles.iter().map(turned).collect();
    there.sort_unstable();
    let mut twins: Vec<[u32; 3]> = there.iter().map(|&[a, b, c]| [a, c, b]).collect();
    twins.sort_unstable();
    there == twins
}

/// No grid edge crosses the offset surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EmptyResult {
    /// The model is nowhere as deep as the shrink.
    #[error(
        "nothing is left at distance {}: the model is at most {} deep, so any distance below -{} \
         leaves nothing", figure(*.distance), figure(*.depth), figure(*.depth)
    )]
    TooDeep {
        /// The offset distance, negative.
        distance: f64,
        /// No ball inside the model has a larger radius.
        depth: f64,
    },
    /// No node of the lattice is inside the offset solid, and it may be there all the same.
    #[error(
        "the offset solid at distance {} is empty or too thin for voxel size {}: no lattice node \
         lies inside it (the model is at most {} deep); choose a smaller voxel size",
        figure(*.distance), figure(*.voxel), figure(*.depth)
    )]
    TooThin {
        /// The offset distance.
        distance: f64,
        /// The voxel size.
        voxel: f64,
        /// No ball inside the model has a larger radius.
        depth: f64,
    },
}

impl EmptyResult {
    /// Searches how deep the model is, and says which of the two it is.
    ///
    /// # Errors
    /// When the run is cancelled meanwhile.
    pub(super) fn explain(
        distance: &SignedDistance,
        settings: &BandSettings,
        run: &RunSettings,
    ) -> Result<Self, Cancelled> {
        let (r, voxel) = (settings.r, settings.lattice.voxel);
        let depth = largest_depth(distance, 1e-3, run)?.at_most;
        Ok(if r + depth < 0.0 {
            EmptyResult::TooDeep { distance: r, depth }
        } else {
            EmptyResult::TooThin { distance: r, voxel, depth }
        })
    }
}

/// A length with six significant digits.
fn figure(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = 5 - x.abs().max(f64::MIN_POSITIVE).log10().floor() as i32;
    match digits {
        1..12 => {
            let text = format!("{x:.0$}", digits as usize);
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        0 => format!("{x:.0}"),
        _ => format!("{x:.5e}"),
    }
}
