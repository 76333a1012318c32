//! The memory that a thickening will take, before it starts.

use super::patch::boundary::Boundary;
use super::settings::ModelUnits;
use crate::mesh::{TriMesh, measure};
use crate::offset::MemoryError;
use crate::system::available_memory;
use glam::DVec3;
use std::f64::consts::PI;

/// Bytes per h^2 of the patch: nodes near it, crossings, contour, strips, shape processing.
///
/// Measured as peak memory on patches of 98 and 2,048 triangles, at 80,000 to 700,000 cells and 4
/// to 12 voxels of thickness: 410 for plane ones, 1,074 at most for wavy ones.
const BYTES_PER_CELL: f64 = 1100.0;

/// Bytes per node within the thickness of the patch, where that is many voxels: the closest
/// triangle, and bits. Measured as 9.4 to 10.6 at a thickness of 200 and 286 voxels.
const BYTES_PER_NODE: f64 = 12.0;

/// Bytes per triangle of the patch: topology, hierarchy, pseudonormals, exact tests, and lists
/// where triangles are smaller than voxels. Measured as 1,500 to 1,750 on patches of 17,000 and
/// 52,000 triangles at 40 voxels.
const BYTES_PER_TRIANGLE: f64 = 1800.0;

/// Checks that a lattice fits into `max_memory` bytes, or into what the system has available.
pub(super) fn check(
    patch: &TriMesh,
    boundary: &Boundary,
    at: ModelUnits,
    max_memory: Option<u64>,
) -> Result<(), MemoryError> {
    let Some(allowed) = max_memory.or_else(available_memory) else { return Ok(()) };
    let ModelUnits { thickness, voxel } = at;
    let fixed = patch.triangles.len() as f64 * BYTES_PER_TRIANGLE;
    let (area, volume) = area_and_volume(patch, boundary, thickness);
    let of_lattice = |h: f64| area / h.powi(2) * BYTES_PER_CELL + volume / h.powi(3) * BYTES_PER_NODE;
    let needed = fixed + of_lattice(voxel);
    if needed <= allowed as f64 {
        return Ok(());
    }
    let room = (allowed as f64 - fixed).max(0.1 * allowed as f64);
    // The memory grows with the square of 1 / h at least, so this is coarse enough.
    let smallest_voxel = voxel * (of_lattice(voxel) / room).sqrt();
    Err(MemoryError { voxel, needed: needed as u64, allowed, smallest_voxel })
}

/// Returns the area of the solid's boundary along patch and wall, and the volume of the points
/// within `r` of the patch on one of its sides.
///
/// Points beyond the boundary of the patch are not in the solid, but their closest points have to
/// be found all the same. The volume is half of what Steiner's formula says of a flat convex patch:
/// a prism, quarters of a cylinder along the boundary and half of a ball at its corners.
fn area_and_volume(patch: &TriMesh, boundary: &Boundary, r: f64) -> (f64, f64) {
    let area = measure::area(patch);
    let corner = |v: u32| DVec3::from(patch.vertices[v as usize]);
    let length = |around: &Vec<u32>| -> f64 {
        let next = around.iter().cycle().skip(1);
        around.iter().zip(next).map(|(&a, &b)| corner(a).distance(corner(b))).sum()
    };
    let around: f64 = boundary.loops.iter().map(length).sum();
    let volume = area * r + 0.25 * PI * around * r.powi(2) + 2.0 / 3.0 * PI * r.powi(3);
    (area + around * r, volume)
}
