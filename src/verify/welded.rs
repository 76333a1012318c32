//! OUTPUT with equal positions made one vertex, and what that left without shape set aside.

use super::error::{VerifyError, Which};
use crate::geom::predicates::projection_axis;
use crate::mesh::{CleanReport, Topology, TriMesh, weld};
use rayon::prelude::*;

/// A mesh whose vertices have different positions, and whose triangles have three different
/// vertices.
#[derive(Debug)]
pub(super) struct Welded {
    pub mesh: TriMesh,
    pub topology: Topology,
    /// Report of the welding.
    pub report: CleanReport,
    /// Triangles of the file with two corners at one position, ascending. They are not in `mesh`.
    pub collapsed: Vec<u32>,
    /// Triangles of `mesh` whose corners are exactly on a line, ascending.
    pub flat: Vec<u32>,
}

impl Welded {
    /// Welds a copy of `mesh`. Runs on the current rayon pool.
    ///
    /// # Errors
    /// [`VerifyError::Mesh`].
    pub fn new(mesh: &TriMesh, which: Which) -> Result<Self, VerifyError> {
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

    /// The number that triangle `t` of `mesh` has in the file.
    pub fn in_file(&self, t: u32) -> u32 {
        // Each collapsed triangle before it moves it on; few meshes have any.
        self.collapsed.iter().fold(t, |number, &collapsed| number + u32::from(collapsed <= number))
    }

    /// Triangles of `mesh` with area.
    pub fn with_area(&self) -> Vec<u32> {
        let all = 0..self.mesh.triangles.len() as u32;
        all.filter(|t| self.flat.binary_search(t).is_err()).collect()
    }
}

/// Checks that a mesh can be looked at.
pub(super) fn check(mesh: &TriMesh, which: Which) -> Result<(), VerifyError> {
    mesh.check().map_err(|source| VerifyError::Mesh { which, source })
}
