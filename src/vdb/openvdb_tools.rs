//! OpenVDB's own way to an offset surface: what `exocarp compare` measures the engine against.
//!
//! Nothing here is used by the engine. The calls are those that a user of OpenVDB would make, in an
//! arena of as many threads as the run has.

use super::VdbError;
use super::bridge::ffi;
use crate::lattice::Lattice;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use cxx::UniquePtr;

/// A level set that OpenVDB made from a mesh.
pub struct VdbLevelSet {
    grid: UniquePtr<ffi::FloatGrid>,
}

/// The widths of a band in voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandWidths {
    /// Outside of the surface.
    pub exterior: f64,
    /// Inside of it.
    pub interior: f64,
}

/// The finite differences with which OpenVDB keeps a level set a distance field while it moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// First-order upwind in space, forward Euler in time.
    FirstOrder,
    /// Fifth-order WENO in space, third-order TVD Runge-Kutta in time.
    Weno5,
}

/// Polygons as OpenVDB makes them: quads and a few triangles, still on its side.
pub struct Polygons {
    polygons: UniquePtr<ffi::Polygons>,
}

impl VdbLevelSet {
    /// OpenVDB's `meshToVolume`: the signed distance to `mesh` in a band around it.
    ///
    /// # Errors
    /// What OpenVDB says: a voxel size that it has no transform for (below 1.5e-5), no memory.
    pub fn from_mesh(
        mesh: &TriMesh,
        lattice: Lattice,
        band: BandWidths,
        run: &RunSettings,
    ) -> Result<Self, VdbError> {
        let points: Vec<f32> = mesh.vertices.iter().flatten().map(|x| (x / lattice.voxel) as f32).collect();
        let grid = ffi::mesh_band(
            lattice.voxel,
            &points,
            mesh.triangles.as_flattened(),
            band.exterior as f32,
            band.interior as f32,
            threads(run),
        )?;
        Ok(VdbLevelSet { grid })
    }

    /// OpenVDB's `LevelSetFilter::offset`, with our sign: a positive `distance`, in model units,
    /// grows. (OpenVDB's own sign is the other one.)
    ///
    /// # Errors
    /// What OpenVDB says.
    pub fn offset(&mut self, distance: f64, scheme: Scheme, run: &RunSettings) -> Result<(), VdbError> {
        let scheme = match scheme {
            Scheme::FirstOrder => ffi::Scheme::First,
            Scheme::Weno5 => ffi::Scheme::Weno5,
        };
        Ok(self.grid.pin_mut().filter_offset(-distance as f32, scheme, threads(run))?)
    }

    /// OpenVDB's `volumeToMesh`: the surface where the level set has the value `iso`, in model
    /// units.
    ///
    /// # Errors
    /// What OpenVDB says.
    pub fn contour(&self, iso: f64, run: &RunSettings) -> Result<Polygons, VdbError> {
        Ok(Polygons { polygons: self.grid.contour(iso, threads(run))? })
    }

    /// The number of active voxels.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn active_voxels(&self) -> Result<u64, VdbError> {
        Ok(self.grid.counts()?.active_voxels)
    }
}

impl Polygons {
    /// The polygons as triangles, counter-clockwise seen from outside; quads are cut from their
    /// first corner to their third.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn to_mesh(&self) -> Result<TriMesh, VdbError> {
        let p = &self.polygons;
        let mut points = vec![0.0f32; 3 * p.point_count()];
        let mut triangles = vec![0u32; 3 * p.triangle_count()];
        let mut quads = vec![0u32; 4 * p.quad_count()];
        p.read(&mut points, &mut triangles, &mut quads)?;
        let vertices = points.as_chunks::<3>().0.iter().map(|p| p.map(f64::from)).collect();
        // OpenVDB's polygons run clockwise seen from outside.
        let whole = triangles.as_chunks::<3>().0.iter().map(|&[a, b, c]| [a, c, b]);
        let halves = quads.as_chunks::<4>().0.iter().flat_map(|&[a, b, c, d]| [[a, c, b], [a, d, c]]);
        Ok(TriMesh { vertices, triangles: whole.chain(halves).collect() })
    }
}

fn threads(run: &RunSettings) -> i32 {
    i32::try_from(run.threads()).unwrap_or(i32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Topology, measure, shapes};
    use std::f64::consts::PI;

    fn volumes(r: f64, make: impl Fn(&TriMesh, Lattice, &RunSettings) -> TriMesh) -> f64 {
        let run = RunSettings::with_threads(2).unwrap();
        let mesh = make(&shapes::sphere(24), Lattice { voxel: 0.05 }, &run);
        assert!(Topology::new(&mesh).defects().is_closed());
        measure::signed_volume(&mesh) / (4.0 / 3.0 * PI * (1.0 + r).powi(3))
    }

    #[test]
    fn a_level_set_offset_grows_for_positive_distances() {
        for (r, scheme) in [(0.3, Scheme::FirstOrder), (-0.3, Scheme::Weno5), (0.3, Scheme::Weno5)] {
            let ratio = volumes(r, |mesh, lattice, run| {
                let band = BandWidths { exterior: 3.0, interior: 3.0 };
                let mut set = VdbLevelSet::from_mesh(mesh, lattice, band, run).unwrap();
                set.offset(r, scheme, run).unwrap();
                set.contour(0.0, run).unwrap().to_mesh().unwrap()
            });
            assert!((ratio - 1.0).abs() < 0.03, "{r} {scheme:?}: {ratio}");
        }
    }

    #[test]
    fn a_wide_band_is_contoured_at_the_distance() {
        for r in [0.3, -0.3] {
            let ratio = volumes(r, |mesh, lattice, run| {
                let band = BandWidths { exterior: 9.0, interior: 9.0 };
                let set = VdbLevelSet::from_mesh(mesh, lattice, band, run).unwrap();
                assert!(set.active_voxels().unwrap() > 1000);
                set.contour(r, run).unwrap().to_mesh().unwrap()
            });
            assert!((ratio - 1.0).abs() < 0.03, "{r}: {ratio}");
        }
    }

    #[test]
    fn what_openvdb_refuses_is_an_error() {
        let run = RunSettings::with_threads(1).unwrap();
        let band = BandWidths { exterior: 3.0, interior: 3.0 };
        assert!(VdbLevelSet::from_mesh(&shapes::cube(2), Lattice { voxel: 1e-9 }, band, &run).is_err());
    }
}
