//! OUTPUT after welding: equal positions are one vertex, and triangles that collapsed are set
//! aside.

use super::error::{MeshRole, VerifyError};
use crate::geom::predicates::projection_axis;
use crate::mesh::{CleanReport, Topology, TriMesh, weld};
use rayon::prelude::*;

/// A mesh whose vertices have different positions, and whose triangles have three different
/// vertices.
#[derive(Debug)]
pub(super) struct Welded {
    pub mesh: TriMesh,
    pub topology: Topology,
    /// Counts of the welding.
    pub report: CleanReport,
    /// Triangles of the file with two corners at one position, ascending; not in `mesh`.
    pub collapsed: Vec<u32>,
    /// Triangles of `mesh` whose corners are exactly on a line, ascending.
    pub flat: Vec<u32>,
}

impl Welded {
    /// Welds a copy of `mesh`. Runs on the current rayon pool.
    ///
    /// # Errors
    /// [`VerifyError::Mesh`].
    pub fn new(mesh: &TriMesh, which: MeshRole) -> Result<Self, VerifyError> {
        check(mesh, which)?;
        let (mut mesh, report) = weld(mesh.clone());
        let is_collapsed = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
        let collapsed: Vec<u32> =
            (0..).zip(&mesh.triangles).filter(|&(_, &t)| is_collapsed(t)).map(|(n, _)| n).collect();
        if !collapsed.is_empty() {
            mesh.triangles.retain(|&t| !is_collapsed(t));
        }
        let flat = (0..mesh.triangles.len() as u32)
            .into_par_iter()
            .filter(|&t| projection_axis(mesh.corners(t as usize)).is_none())
            .collect();
        let topology = Topology::new(&mesh);
        Ok(Welded { mesh, topology, report, collapsed, flat })
    }

    /// Returns the number in the file of triangle `t` of `mesh`.
    pub fn in_file(&self, t: u32) -> u32 {
        // Each collapsed triangle before it shifts the number; few meshes have any.
        self.collapsed.iter().fold(t, |number, &collapsed| number + u32::from(collapsed <= number))
    }

    /// Returns the triangles of `mesh` with area.
    pub fn with_area(&self) -> Vec<u32> {
        let all = 0..self.mesh.triangles.len() as u32;
        all.filter(|t| self.flat.binary_search(t).is_err()).collect()
    }
}

/// Checks that a mesh has finite coordinates and no vertex number out of range.
pub(super) fn check(mesh: &TriMesh, which: MeshRole) -> Result<(), VerifyError> {
    mesh.check().map_err(|source| VerifyError::Mesh { which, source })
}
