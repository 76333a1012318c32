//! Why an offset cannot be made, told before the work starts where that is possible.

use super::SignMode;
use super::stored_band::Wanted;
use crate::band::BandSettings;
use crate::distance::{SignedDistance, largest_depth};
use crate::edge::TooManyEdges;
use crate::geom::aabb::Aabb;
use crate::mesh::{MeshError, Topology, TriMesh, measure};
use crate::run::{Bytes, Cancelled, RunSettings};
use glam::DVec3;

/// The input is not the boundary of a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InputError {
    /// There is no triangle.
    #[error("the mesh has no triangles")]
    NoTriangles,
    /// A vertex or a triangle cannot be worked with.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Edges with a single triangle.
    #[error(
        "the mesh is not closed: {count} boundary edges, the first from ({:.6}, {:.6}, {:.6}) to ({:.6}, \
         {:.6}, {:.6}); close its holes, or go ahead all the same with --sign pseudonormal",
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
         from ({:.6}, {:.6}, {:.6}) to ({:.6}, {:.6}, {:.6}); reorient its triangles, or go ahead all the \
         same with --sign pseudonormal",
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
pub(super) fn check_input(mesh: &TriMesh, topology: &Topology, sign: SignMode) -> Result<(), InputError> {
    if sign == SignMode::Pseudonormal {
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

/// The work would not fit into memory.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "voxel size {voxel} needs about {} of memory, and {} are allowed; the smallest voxel size that fits is \
     about {smallest_voxel:.3e} (or raise --max-memory)",
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

impl MemoryError {
    /// Not even the thinnest slabs fit.
    pub(super) fn of_slabs(
        mesh: &TriMesh,
        settings: &BandSettings,
        leaves: u64,
        allowed: u64,
    ) -> MemoryError {
        let voxel = settings.lattice.voxel;
        let needed = input_bytes(mesh) + leaves * BYTES_PER_LEAF;
        // The leaves of a layer and its halo lie along curves: they double when the voxel size is halved.
        let room = allowed.saturating_sub(input_bytes(mesh)).max(allowed / 10);
        let smallest_voxel = voxel * (leaves * BYTES_PER_LEAF) as f64 / room as f64;
        MemoryError { voxel, needed, allowed, smallest_voxel }
    }
}

/// Peak memory per leaf of the band without what the input takes, in bytes: signs, closest triangles, lists, crossings,
/// cells and mesh. Measured on nine models in four distances at 512 voxels, and rounded up: at most 11,700 for meshes alone,
/// 14,300 with the band in OpenVDB, too.
const BYTES_PER_LEAF: u64 = 16_000;

/// The leaves whose work fits into this many bytes beside the input.
pub(super) fn leaves_within(mesh: &TriMesh, bytes: u64) -> u64 {
    bytes.saturating_sub(input_bytes(mesh)) / BYTES_PER_LEAF
}

/// What the input takes, in bytes.
fn input_bytes(mesh: &TriMesh) -> u64 {
    (mesh.triangles.len() as f64 * BYTES_PER_TRIANGLE) as u64
}

/// Bytes per h^2 of offset surface: band, crossings, cells and mesh. Measured as peak memory over area / h^2 on the same models, at
/// most 298, and rounded up: too low, and the machine swaps; too high, and work that fits is refused.
const BYTES_PER_CELL: f64 = 350.0;

/// What the level set in OpenVDB adds to that. With a half width of 3 it was 530 together at most (five models in three
/// distances at 512 voxels).
const BYTES_PER_STORED_CELL: f64 = 100.0;

/// What the closest triangles in OpenVDB add to both: it was 640 together at most.
const BYTES_PER_CLOSEST_CELL: f64 = 90.0;

/// The same for each voxel of half-width beyond the first.
const BYTES_PER_CELL_AND_VOXEL: f64 = 60.0;

/// Bytes per input triangle: hierarchy, topology, pseudonormals.
const BYTES_PER_TRIANGLE: f64 = 260.0;

/// Checks that an offset fits into memory, with its band in OpenVDB if it is kept.
pub(super) fn check_memory(
    mesh: &TriMesh,
    settings: &BandSettings,
    stored: Wanted,
    max_memory: Option<u64>,
) -> Result<(), MemoryError> {
    let Some(allowed) = max_memory.or_else(available_memory) else { return Ok(()) };
    let area = offset_area(mesh, settings.r);
    let voxel = settings.lattice.voxel;
    let stored = match stored {
        Wanted::Nothing => 0.0,
        Wanted::LevelSet => BYTES_PER_STORED_CELL,
        Wanted::WithClosest => BYTES_PER_STORED_CELL + BYTES_PER_CLOSEST_CELL,
    };
    let per_cell = BYTES_PER_CELL + stored + (settings.half_width - 1.0) * BYTES_PER_CELL_AND_VOXEL;
    let fixed = input_bytes(mesh) as f64;
    let needed = fixed + area / (voxel * voxel) * per_cell;
    if needed <= allowed as f64 {
        return Ok(());
    }
    let room = (allowed as f64 - fixed).max(0.1 * allowed as f64);
    let smallest_voxel = (area * per_cell / room).sqrt();
    Err(MemoryError { voxel, needed: needed as u64, allowed, smallest_voxel })
}

/// Refuses what would have more vertices than can be numbered, in slabs or not, before leaves are counted for a long
/// time.
pub(super) fn check_countable(mesh: &TriMesh, settings: &BandSettings) -> Result<(), TooManyEdges> {
    // The area is estimated too high where the surface folds; what gets past is found when edges are numbered.
    const LEEWAY: f64 = 4.0;
    let cells = offset_area(mesh, settings.r) / settings.lattice.voxel.powi(2);
    if cells > LEEWAY * f64::from(u32::MAX) { Err(TooManyEdges) } else { Ok(()) }
}

/// An estimate of the offset surface's area. A ball with the mesh's area A grows to A + 2 sqrt(4 pi A) r +
/// 4 pi r^2 (Steiner's formula for a ball); folds fill up long before the surface exceeds a ball around
/// everything.
fn offset_area(mesh: &TriMesh, r: f64) -> f64 {
    use std::f64::consts::PI;
    let area = measure::area(mesh);
    let r = r.max(0.0);
    let radius = 0.5 * Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v))).diagonal() + r;
    let grown = area + 2.0 * (4.0 * PI * area).sqrt() * r + 4.0 * PI * r * r;
    if r == 0.0 { area } else { grown.min(area.max(4.0 * PI * radius * radius)) }
}

/// Memory that the system can give without swapping, in bytes, where it says so.
pub fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib * 1024)
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
