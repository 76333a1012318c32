//! The statistics file: one JSON object, lengths in model units, times in seconds.
//!
//! Its field names are a contract with those who read it. The engine's parts come as it serialises them.

use super::args::OffsetArguments;
use super::resources::peak_rss;
use super::session::Session;
use exocarp::mesh::{Topology, TriMesh};
use exocarp::offset::{EngineTimes, OffsetSettings, OffsetStatistics, VoxelSize};
use serde::Serialize;

/// Everything about one run of `exocarp offset`.
#[derive(Debug, Serialize)]
pub(super) struct OffsetFile<'a> {
    exocarp: &'static str,
    command: &'static str,
    input: &'a MeshFacts,
    settings: Settings,
    phases: &'a Phases,
    wall: f64,
    /// Bytes; 0 where the system does not tell.
    peak_rss: u64,
    #[serde(flatten)]
    engine: serde_json::Map<String, serde_json::Value>,
}

/// The input as it was offset, after cleaning; also what `exocarp info` says of a mesh.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MeshFacts {
    pub path: String,
    pub vertices: usize,
    pub triangles: usize,
    pub bbox: [[f64; 3]; 2],
    pub diagonal: f64,
    pub closed: bool,
    pub manifold: bool,
    pub components: usize,
}

impl MeshFacts {
    pub fn new(path: &std::path::Path, mesh: &TriMesh, topology: &Topology) -> Self {
        let bbox = mesh.bounding_box().unwrap_or_default();
        let [lo, hi] = bbox;
        MeshFacts {
            path: path.display().to_string(),
            vertices: mesh.vertices.len(),
            triangles: mesh.triangles.len(),
            bbox,
            diagonal: (0..3).map(|a| (hi[a] - lo[a]).powi(2)).sum::<f64>().sqrt(),
            closed: topology.defects().is_closed(),
            manifold: topology.defects().non_manifold_edges == 0,
            components: topology.components(),
        }
    }
}

#[derive(Debug, Serialize)]
struct Settings {
    distance: f64,
    voxel: f64,
    /// `null` when the voxel size was given.
    resolution: Option<u32>,
    sign: &'static str,
    threads: usize,
    half_width: f64,
}

/// Seconds per phase.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Phases {
    pub load: f64,
    pub clean: f64,
    #[serde(flatten)]
    pub engine: EngineTimes,
    pub write: f64,
}

impl<'a> OffsetFile<'a> {
    /// The file's content; `wall` and the peak of memory are taken now.
    pub fn new(
        arguments: &OffsetArguments,
        settings: &OffsetSettings,
        input: &'a MeshFacts,
        engine: &OffsetStatistics,
        phases: &'a Phases,
        session: &Session,
    ) -> Result<Self, serde_json::Error> {
        let mut parts = match serde_json::to_value(engine)? {
            serde_json::Value::Object(parts) => parts,
            _ => serde_json::Map::new(),
        };
        // These stand under `settings` and `phases`.
        parts.retain(|name, _| !["distance", "voxel", "times"].contains(&name.as_str()));
        let resolution = match settings.voxel {
            VoxelSize::Resolution(n) => Some(n),
            VoxelSize::Units(_) => None,
        };
        Ok(OffsetFile {
            exocarp: env!("CARGO_PKG_VERSION"),
            command: "offset",
            input,
            settings: Settings {
                distance: engine.distance,
                voxel: engine.voxel,
                resolution,
                sign: arguments.sign.name(),
                threads: session.run.threads(),
                half_width: settings.half_width,
            },
            phases,
            wall: session.wall(),
            peak_rss: peak_rss(),
            engine: parts,
        })
    }
}
