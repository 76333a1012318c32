//! The solid of a surface on one lattice: the row of steps.

use super::error::Blocked;
use super::finish::shape::{self, Face, Moving, Rounds, Shaped};
use super::patch::boundary::Boundary;
use super::settings::Resolved;
use super::solid::crossings;
use super::solid::nodes::{Extent, Nodes};
use super::solid::region::Solid;
use super::solid::vertex_pillars::Rods;
use super::stitch::join::{self, Stitched};
use super::stitch::open_mesh::OpenMesh;
use super::stitch::rim::Reach;
use super::{ThickenError, ThickenSettings, ThickenTimes, closed_shell, memory_estimate};
use crate::distance::SignedDistance;
use crate::error::Error;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::offset::MemoryError;
use crate::run::{Phase, RunSettings};
use glam::DVec3;
use std::time::Instant;

/// Depth of the lid in voxels. Deeper, and less is left of a thin solid; less deep, and the strip between the patch and
/// the section gets so narrow that a patch that is bent within a voxel pierces it.
const LID: f64 = 0.5;

/// Radius in voxels of the rods that join parts of S which touch in a vertex. A rod must hold nodes at each height, and the
/// rim around it must stay apart from the vertex; much thicker, and it shows.
const ROD: f64 = 1.5;

/// Nodes of the band beyond the shell, in voxels: an edge that crosses the shell ends at most one beyond it.
const BEYOND: f64 = 1.01;

/// What stays the same on all lattices, and what they took.
pub(super) struct Work<'a> {
    pub settings: &'a ThickenSettings,
    pub run: &'a RunSettings,
    pub times: ThickenTimes,
    /// What the last lattice's shape processing did.
    pub shaped: Shaped,
}

/// What is known of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface<'a> {
    pub topology: &'a Topology,
    pub boundary: &'a Boundary,
}

impl Work<'_> {
    /// Checks that a lattice fits into the memory that the settings allow.
    pub fn check_memory(
        &self,
        patch: &TriMesh,
        boundary: &Boundary,
        at: Resolved,
    ) -> Result<(), MemoryError> {
        // A closed patch's solid is made of an offset, which checks that itself.
        if boundary.is_empty() && self.settings.map.is_none() {
            return Ok(());
        }
        memory_estimate::check(patch, boundary, at, self.settings.max_memory)
    }

    /// The solid on one side of `surface`, whose triangles are its first ones.
    pub fn on_lattice(
        &mut self,
        surface: &TriMesh,
        known: Option<Surface<'_>>,
        at: Resolved,
    ) -> Result<Result<TriMesh, Blocked>, Error> {
        let Work { settings, run, ref mut times, ref mut shaped } = *self;
        let Resolved { thickness, voxel } = at;
        let started = Instant::now();
        let (own_topology, own_boundary);
        let Surface { topology, boundary } = match known {
            Some(known) => known,
            None => {
                own_topology = run.install(|| Topology::new(surface));
                own_boundary = Boundary::new(surface, &own_topology).map_err(ThickenError::from)?;
                Surface { topology: &own_topology, boundary: &own_boundary }
            }
        };
        if boundary.is_empty() && settings.map.is_none() {
            times.hierarchy += started.elapsed().as_secs_f64();
            return Ok(Ok(closed_shell::shell(surface, at, settings, times, run)?));
        }
        let distance = {
            let _phase = run.phase(Phase::Hierarchy, 0);
            run.install(|| SignedDistance::new(surface, topology))
        };
        run.check()?;
        times.hierarchy += started.elapsed().as_secs_f64();

        let lattice = Lattice { voxel };
        let started = Instant::now();
        let thinnest = settings.map.iter().flatten().copied().fold(thickness, f64::min);
        let extent = Extent {
            reach: thickness + BEYOND * voxel,
            above: (BEYOND - LID) * voxel,
            inside: [(LID + BEYOND) * voxel, thinnest - BEYOND * voxel],
        };
        let (nodes, lists) = Nodes::new(&distance, boundary, lattice, extent, run)?;
        let solid = Solid {
            distance: &distance,
            boundary,
            thickness,
            map: settings.map.as_deref(),
            lid: LID * voxel,
            rods: &Rods::new(surface, boundary, thickness, ROD * voxel),
            lists: Some(&lists),
        };
        let (signs, triangles) = nodes.classify(&solid, lattice, run);
        times.nodes += started.elapsed().as_secs_f64();

        let started = Instant::now();
        let found = crossings::crossings(&solid, lattice, &signs, &triangles, run)?;
        let open = OpenMesh::new(&signs, &found, lattice, settings.precision, run)?;
        times.faces += started.elapsed().as_secs_f64();

        let started = Instant::now();
        let reach = Reach { across: 1.5 * thickness, along: 4.0 * voxel };
        let stitched = run.install(|| join::stitch(surface, boundary, open, reach, run))?;
        times.boundary += started.elapsed().as_secs_f64();
        let Stitched { mut mesh, edges } = match stitched {
            Ok(stitched) => stitched,
            Err(blocked) => return Ok(Err(blocked)),
        };

        let started = Instant::now();
        let face = |&edge: &u32| Face {
            part: found.parts[edge as usize],
            point: found.points[edge as usize],
            normal: DVec3::from(found.crossings.samples[edge as usize].normal.map(f64::from)),
        };
        let moving = Moving {
            first: surface.triangles.len(),
            faces: edges.iter().map(face).collect(),
            first_vertex: surface.vertices.len() as u32,
        };
        let rounds = Rounds { most: settings.rounds, normals: settings.section_normals };
        let precision = settings.precision;
        let shape = || shape::process(&mut mesh, moving, &solid, voxel, precision, rounds, run);
        *shaped = run.install(shape)?;
        times.shape += started.elapsed().as_secs_f64();
        Ok(Ok(mesh))
    }
}
