//! One attempt to make the solid, on one lattice: the row of steps.

use super::finish::shape::{self, ContourFace, MovableFaces, ShapeSettings};
use super::outcome::Outcome;
use super::patch::boundary::Boundary;
use super::settings::ModelUnits;
use super::solid::crossings::{self, SolidCrossings};
use super::solid::nodes::{NodeRange, Nodes};
use super::solid::region::Solid;
use super::solid::vertex_pillars::VertexPillars;
use super::stitch::join::{self, ClosedMesh};
use super::stitch::open_mesh::OpenMesh;
use super::stitch::rim::RimLimits;
use super::{ShapeCounts, ThickenError, ThickenSettings, ThickenTimes, closed_shell, memory_estimate};
use crate::distance::SignedDistance;
use crate::lattice::Lattice;
use crate::mesh::{Topology, TriMesh};
use crate::offset::MemoryError;
use crate::run::{Phase, RunSettings};
use glam::DVec3;
use std::time::Instant;

/// Depth of the inset, in voxels. Deeper, and less is left of a thin solid. Less deep, and the
/// strip between the patch and the section gets so narrow that a patch bent within a voxel pierces
/// it.
const INSET_DEPTH: f64 = 0.5;

/// Radius of the pillars below vertices in which parts of S touch, in voxels. A pillar must hold
/// nodes at each height, and the rim around it must stay apart from the vertex. Much thicker, and
/// it shows.
const PILLAR_RADIUS: f64 = 1.5;

/// Width of the band beyond the shell, in voxels. A lattice edge that crosses the shell ends at
/// most one voxel beyond it.
const BAND_MARGIN: f64 = 1.01;

/// Attempts to make the solid: settings that all have in common, and what they took.
pub(super) struct Attempts<'a> {
    pub settings: &'a ThickenSettings,
    pub run: &'a RunSettings,
    /// Times of all attempts so far.
    pub times: ThickenTimes,
    /// Counts of the last attempt's shape processing.
    pub shape: ShapeCounts,
}

/// Topology and boundary of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceFacts<'a> {
    pub topology: &'a Topology,
    pub boundary: &'a Boundary,
}

impl Attempts<'_> {
    /// Checks that a lattice fits into the memory that the settings allow.
    pub fn check_memory(
        &self,
        patch: &TriMesh,
        boundary: &Boundary,
        at: ModelUnits,
    ) -> Result<(), MemoryError> {
        // A closed patch's solid is made of an offset, which checks that itself.
        if boundary.is_empty() && self.settings.thickness_map.is_none() {
            return Ok(());
        }
        memory_estimate::check(patch, boundary, at, self.settings.max_memory)
    }

    /// Makes the solid on one side of `surface` on one lattice. The solid's first triangles are
    /// those of `surface`. `facts` are computed here unless they are known.
    pub fn attempt(
        &mut self,
        surface: &TriMesh,
        facts: Option<SurfaceFacts<'_>>,
        at: ModelUnits,
    ) -> Result<Outcome<TriMesh>, ThickenError> {
        let Attempts { settings, run, ref mut times, shape: ref mut shape_counts } = *self;
        let ModelUnits { thickness, voxel } = at;
        let started = Instant::now();
        let (own_topology, own_boundary);
        let SurfaceFacts { topology, boundary } = match facts {
            Some(facts) => facts,
            None => {
                own_topology = run.install(|| Topology::new(surface));
                own_boundary = Boundary::new(surface, &own_topology)?;
                SurfaceFacts { topology: &own_topology, boundary: &own_boundary }
            }
        };
        if boundary.is_empty() && settings.thickness_map.is_none() {
            times.hierarchy += started.elapsed().as_secs_f64();
            let mesh = closed_shell::closed_shell(surface, at, settings, times, run)?;
            return Ok(Outcome::Done(mesh));
        }
        let distance = {
            let _phase = run.phase(Phase::Hierarchy, 0);
            run.install(|| SignedDistance::new(surface, topology))
        };
        run.check()?;
        times.hierarchy += started.elapsed().as_secs_f64();

        let lattice = Lattice { voxel };
        let started = Instant::now();
        let thinnest = settings.thickness_map.iter().flatten().copied().fold(thickness, f64::min);
        let range = NodeRange {
            max_distance: thickness + BAND_MARGIN * voxel,
            max_height: (BAND_MARGIN - INSET_DEPTH) * voxel,
            sure_inside: [(INSET_DEPTH + BAND_MARGIN) * voxel, thinnest - BAND_MARGIN * voxel],
        };
        let (nodes, lists) = Nodes::new(&distance, boundary, lattice, range, run)?;
        let solid = Solid {
            distance: &distance,
            boundary,
            thickness,
            thickness_map: settings.thickness_map.as_deref(),
            inset_depth: INSET_DEPTH * voxel,
            pillars: &VertexPillars::new(surface, boundary, thickness, PILLAR_RADIUS * voxel),
            lists: Some(&lists),
        };
        let (signs, triangles) = nodes.classify(&solid, lattice, run);
        times.nodes += started.elapsed().as_secs_f64();

        let started = Instant::now();
        let found = crossings::crossings(&solid, lattice, &signs, &triangles, run)?;
        let open = OpenMesh::new(&signs, &found, lattice, settings.precision, run)?;
        times.faces += started.elapsed().as_secs_f64();

        let started = Instant::now();
        let limits = RimLimits { max_distance: 1.5 * thickness, max_slide: 4.0 * voxel };
        let joined = run.install(|| join::join(surface, boundary, open, limits, run))?;
        times.boundary += started.elapsed().as_secs_f64();
        let ClosedMesh { mut mesh, edges } = match joined {
            Outcome::Done(closed) => closed,
            Outcome::Blocked(blockage) => return Ok(Outcome::Blocked(blockage)),
        };

        let started = Instant::now();
        let movable = movable_faces(surface, &found, &edges);
        let shape = ShapeSettings {
            max_rounds: settings.rounds,
            normals: settings.section_normals,
            precision: settings.precision,
        };
        *shape_counts =
            run.install(|| shape::process_shape(&mut mesh, movable, &solid, voxel, shape, run))?;
        times.shape += started.elapsed().as_secs_f64();
        Ok(Outcome::Done(mesh))
    }
}

/// Returns the faces of the contour, whose triangles follow those of `surface`. `edges` has the
/// number of each triangle's lattice edge.
fn movable_faces(surface: &TriMesh, found: &SolidCrossings, edges: &[u32]) -> MovableFaces {
    let face = |&edge: &u32| ContourFace {
        of: found.faces[edge as usize],
        point: found.points[edge as usize],
        normal: DVec3::from(found.crossings.samples[edge as usize].normal.map(f64::from)),
    };
    MovableFaces {
        first: surface.triangles.len(),
        faces: edges.iter().map(face).collect(),
        first_vertex: surface.vertices.len() as u32,
    }
}
