//! Memory of an offset, estimated before the band is made.

use super::error::{MemoryError, OffsetError};
use crate::band::narrow_band::StoredPart;
use crate::band::{BandSettings, count_layers};
use crate::distance::SignedDistance;
use crate::geom::aabb::Aabb;
use crate::lattice::{Lattice, LatticeError};
use crate::mesh::{TriMesh, measure};
use crate::run::{Cancelled, RunSettings};
use crate::system::available_memory;
use glam::DVec3;

impl MemoryError {
    /// Not even the thinnest slabs fit.
    pub(super) fn of_slabs(
        mesh: &TriMesh,
        settings: &BandSettings,
        leaves: u64,
        allowed: u64,
    ) -> MemoryError {
        let voxel = settings.lattice.voxel;
        let fixed = slab_bytes(mesh);
        let needed = fixed + leaves * BYTES_PER_LEAF;
        // The leaves of a layer and its halo lie along curves: they double when the voxel size is
        // halved.
        let room = allowed.saturating_sub(fixed).max(allowed / 10).max(1);
        let smallest_voxel = voxel * (leaves * BYTES_PER_LEAF) as f64 / room as f64;
        MemoryError { voxel, needed, allowed, smallest_voxel }
    }
}

// Everything below is peak memory of the whole program, measured on nine models (armadillo,
// fandisk, rocker-arm, anchor, bunny, elephant, knot, cheese, dragon) at +2% and -2%, 64 to 1024
// voxels. The sums are within 20% of what was taken.

/// Bytes that the program takes by itself, OpenVDB's library and its tables included.
const BYTES_OF_PROGRAM: u64 = 42_000_000;

/// Bytes per input triangle: topology, hierarchy, pseudonormals.
const BYTES_PER_TRIANGLE: f64 = 240.0;

/// Bytes per cell that the surface passes through: band, crossings, cells and mesh.
const BYTES_PER_CELL: f64 = 140.0;

/// Bytes per cell for the features and the lists of triangles there, as long as there are more
/// triangles than cells.
const BYTES_PER_DENSE_CELL: f64 = 130.0;

/// Bytes per input triangle for the same, once there are more cells than triangles.
const BYTES_PER_FEATURE: f64 = 150.0;

/// Bytes per cell of the level set in OpenVDB, and per voxel of half-width beyond the first.
const BYTES_PER_STORED_CELL: [f64; 2] = [30.0, 25.0];

/// Bytes per cell of the closest triangles in OpenVDB.
#[cfg(feature = "openvdb")]
const BYTES_PER_CLOSEST_CELL: f64 = 60.0;

/// Peak memory per leaf of a slab's band, in bytes: of its cells, with the level set in OpenVDB,
/// and a little more, since what a slab leaves to the next one is not counted.
const BYTES_PER_LEAF: u64 = 11_500;

/// The leaves whose work fits into this many bytes beside program and input.
pub(super) fn leaves_within(mesh: &TriMesh, bytes: u64) -> u64 {
    bytes.saturating_sub(slab_bytes(mesh)) / BYTES_PER_LEAF
}

/// Returns the bytes of program, input and the lists of its triangles: with slabs, and however
/// small they are.
fn slab_bytes(mesh: &TriMesh) -> u64 {
    fixed_bytes(mesh) + (mesh.triangles.len() as f64 * BYTES_PER_FEATURE) as u64
}

/// Returns the bytes of program and input.
fn fixed_bytes(mesh: &TriMesh) -> u64 {
    BYTES_OF_PROGRAM + (mesh.triangles.len() as f64 * BYTES_PER_TRIANGLE) as u64
}

/// Checks that an offset fits into memory, with what is kept of its band.
///
/// # Errors
/// [`OffsetError::Memory`] when it does not; [`OffsetError::Cancelled`].
pub(super) fn check_memory(
    distance: &SignedDistance,
    settings: &BandSettings,
    stored: StoredPart,
    max_memory: Option<u64>,
    run: &RunSettings,
) -> Result<(), OffsetError> {
    let Some(allowed) = max_memory.or_else(available_memory) else { return Ok(()) };
    let (mesh, voxel) = (distance.mesh(), settings.lattice.voxel);
    let wide = settings.half_width - 1.0;
    let stored = match stored {
        StoredPart::Nothing => 0.0,
        #[cfg(feature = "openvdb")]
        StoredPart::LevelSet => BYTES_PER_STORED_CELL[0],
        #[cfg(feature = "openvdb")]
        StoredPart::WithClosest => BYTES_PER_STORED_CELL[0] + BYTES_PER_CLOSEST_CELL,
    } + wide * BYTES_PER_STORED_CELL[1];
    let fixed = fixed_bytes(mesh) as f64;
    let of_cells = |cells: f64| {
        let features = (cells * BYTES_PER_DENSE_CELL).min(mesh.triangles.len() as f64 * BYTES_PER_FEATURE);
        cells * (BYTES_PER_CELL + stored) + features
    };
    // The area is quickly known to be enough, and it is estimated too high more often than too low.
    const LEEWAY: f64 = 2.0;
    let cells = CELLS_PER_AREA * offset_area(mesh, settings.r) / voxel.powi(2);
    if fixed + LEEWAY * of_cells(cells) <= allowed as f64 {
        return Ok(());
    }
    let cells = count_cells(distance, settings, run)?;
    let needed = fixed + of_cells(cells);
    if needed <= allowed as f64 {
        return Ok(());
    }
    let room = (allowed as f64 - fixed).max(0.1 * allowed as f64).max(1.0);
    let smallest_voxel = voxel * (of_cells(cells) / room).sqrt();
    Err(MemoryError { voxel, needed: needed as u64, allowed, smallest_voxel }.into())
}

/// Cells that a plane of area h^2 passes through, on average over its directions.
const CELLS_PER_AREA: f64 = 1.5;

/// Cells that the surface passes through for each leaf that the coarse filters keep: they keep
/// leaves up to some 8 voxels beside it.
const CELLS_PER_LEAF: f64 = 49.0;

/// Voxels along the longest side of the lattice that is counted on where the one that is asked for
/// is finer: a few percent of the work of a band at that resolution.
const COARSE: f64 = 256.0;

/// An estimate of the cells that the offset surface passes through, from the leaves that the coarse
/// filters keep.
fn count_cells(
    distance: &SignedDistance,
    settings: &BandSettings,
    run: &RunSettings,
) -> Result<f64, Cancelled> {
    let bounds = Aabb::around(distance.mesh().vertices.iter().map(|&v| DVec3::from(v)));
    let longest = bounds.size().max_element() + 2.0 * settings.r.max(0.0);
    let voxel = settings.lattice.voxel;
    let coarse = voxel.max(longest / COARSE);
    let lattice = Lattice { voxel: coarse };
    let layers = count_layers(distance, &BandSettings { lattice, half_width: 1.0, ..*settings }, run)?;
    Ok(CELLS_PER_LEAF * layers.total() as f64 * (coarse / voxel).powi(2))
}

/// Refuses what would have more vertices than can be numbered, in slabs or not, before leaves are
/// counted for a long time.
pub(super) fn check_countable(mesh: &TriMesh, settings: &BandSettings) -> Result<(), LatticeError> {
    // The area is estimated too high where the surface folds; what gets past is found when edges
    // are numbered.
    const LEEWAY: f64 = 4.0;
    let cells = offset_area(mesh, settings.r) / settings.lattice.voxel.powi(2);
    if cells > LEEWAY * f64::from(u32::MAX) { Err(LatticeError::TooManyEdges) } else { Ok(()) }
}

/// An estimate of the offset surface's area. A ball with the mesh's area A grows to A + 2 sqrt(4 pi
/// A) r + 4 pi r^2 (Steiner's formula for a ball); folds fill up long before the surface exceeds a
/// ball around everything.
fn offset_area(mesh: &TriMesh, r: f64) -> f64 {
    use std::f64::consts::PI;
    let area = measure::area(mesh);
    let r = r.max(0.0);
    let radius = 0.5 * Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v))).diagonal() + r;
    let grown = area + 2.0 * (4.0 * PI * area).sqrt() * r + 4.0 * PI * r * r;
    if r == 0.0 { area } else { grown.min(area.max(4.0 * PI * radius * radius)) }
}
