//! One method, once: what runs in a process of its own.

use super::measurement::{Measurement, PhaseTime};
use super::{CompareError, Method, Needs};
use crate::lattice::Lattice;
use crate::mesh::TriMesh;
use crate::offset::{OffsetSettings, offset};
use crate::quantity::{Length, VoxelSize};
use crate::run::RunSettings;
use crate::system::peak_memory;
use crate::vdb::openvdb_tools::{BandWidths, Scheme, VdbLevelSet};
use std::path::PathBuf;
use std::time::Instant;

/// The run of one process.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The method.
    pub method: Method,
    /// The mesh file to offset, cleaned.
    pub input: PathBuf,
    /// Signed distance in model units.
    pub distance: f64,
    /// Voxel size in model units.
    pub voxel: f64,
    /// Path of the offset surface, written as binary PLY.
    pub output: PathBuf,
}

/// Width in voxels of the narrow band that OpenVDB's level-set tools want on each side of the
/// surface, and of what a wide band has beyond the distance.
const HALF_WIDTH: f64 = 3.0;

/// Runs a method of this program or of OpenVDB in this process: loads the mesh, measures, writes
/// the surface.
///
/// # Errors
/// Whatever fails; [`CompareError::NotHere`] for MeshLib's methods,
/// which run in Python.
pub fn work(job: &Job, run: &RunSettings) -> Result<Measurement, CompareError> {
    if job.method.needs() != Needs::Nothing {
        return Err(CompareError::NotHere(job.method));
    }
    let mesh = TriMesh::load(&job.input)?;
    let memory_before = peak_memory();
    let started = Instant::now();
    let made = match job.method {
        Method::Exocarp => engine(&mesh, job, run)?,
        _ => openvdb(&mesh, job, run)?,
    };
    let engine = started.elapsed().as_secs_f64();
    let measurement = Measurement {
        method: job.method,
        engine,
        phases: made.phases,
        peak_memory: peak_memory(),
        memory_before,
        active_voxels: Some(made.active_voxels),
        triangles: made.mesh.triangles.len() as u64,
    };
    made.mesh.save(&job.output)?;
    Ok(measurement)
}

struct Made {
    mesh: TriMesh,
    phases: Vec<PhaseTime>,
    active_voxels: u64,
}

fn engine(mesh: &TriMesh, job: &Job, run: &RunSettings) -> Result<Made, CompareError> {
    let settings = OffsetSettings {
        distance: Length::Units(job.distance),
        voxel: VoxelSize::Units(job.voxel),
        ..OffsetSettings::default()
    };
    let result = offset(mesh, &settings, run)?;
    let times = result.statistics.times;
    let phases = [
        ("hierarchy", times.hierarchy),
        ("band", times.band),
        ("edges", times.edges),
        ("contour", times.contour),
    ];
    Ok(Made {
        mesh: result.mesh,
        phases: phases.map(|(name, seconds)| PhaseTime::new(name, seconds)).into(),
        active_voxels: result.statistics.vdb.active_voxels,
    })
}

fn openvdb(mesh: &TriMesh, job: &Job, run: &RunSettings) -> Result<Made, CompareError> {
    let lattice = Lattice { voxel: job.voxel };
    let reach = |side: f64| (side * job.distance / job.voxel).max(0.0) + HALF_WIDTH;
    let wide = job.method == Method::OpenvdbWide;
    let band = match wide {
        true => BandWidths { exterior: reach(1.0), interior: reach(-1.0) },
        false => BandWidths { exterior: HALF_WIDTH, interior: HALF_WIDTH },
    };
    let mut phases = Vec::new();
    let mut started = Instant::now();
    let mut lap = |name: &str| {
        phases.push(PhaseTime::new(name, started.elapsed().as_secs_f64()));
        started = Instant::now();
    };
    let mut set = VdbLevelSet::from_mesh(mesh, lattice, band, run)?;
    lap("band");
    if !wide {
        let scheme = match job.method {
            Method::OpenvdbWeno5 => Scheme::Weno5,
            _ => Scheme::FirstOrder,
        };
        set.offset(job.distance, scheme, run)?;
        lap("offset");
    }
    let polygons = set.contour(if wide { job.distance } else { 0.0 }, run)?;
    let mesh = polygons.to_mesh()?;
    lap("contour");
    Ok(Made { mesh, phases, active_voxels: set.active_voxels()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{measure, shapes};

    #[test]
    fn every_method_here_offsets_a_sphere() {
        let directory = tempfile::tempdir().unwrap();
        let run = RunSettings::with_threads(2).unwrap();
        let input = directory.path().join("in.ply");
        shapes::sphere(16).save(&input).unwrap();
        for method in Method::ALL {
            let output = directory.path().join("out.ply");
            let job = Job { method, input: input.clone(), distance: 0.2, voxel: 0.1, output };
            let made = work(&job, &run);
            if method.needs() == Needs::Meshlib {
                assert!(made.unwrap_err().to_string().contains("Python"));
                continue;
            }
            let made = made.unwrap();
            let mesh = TriMesh::load(&job.output).unwrap();
            assert_eq!(made.triangles, mesh.triangles.len() as u64);
            assert!(made.active_voxels > Some(1000), "{made:?}");
            let named: f64 = made.phases.iter().map(|p| p.seconds).sum();
            assert!(named > 0.0 && named <= made.engine, "{made:?}");
            let ratio = measure::signed_volume(&mesh) / (4.0 / 3.0 * std::f64::consts::PI * 1.2f64.powi(3));
            assert!((ratio - 1.0).abs() < 0.05, "{method:?}: {ratio}");
        }
    }
}
