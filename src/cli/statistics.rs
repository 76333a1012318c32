//! The statistics file: one JSON object, lengths in model units, times in seconds.
//!
//! Its field names are a contract with those who read it. The engine's parts come as it serialises
//! them.

use super::session::Session;
use exocarp::TriMesh;
use exocarp::internals::mesh::Topology;
use exocarp::internals::system::peak_memory;
use serde::Serialize;

/// Everything about one run: `S` are its settings, `T` the engine's times.
#[derive(Debug, Serialize)]
pub(super) struct RunFile<'a, S, T> {
    exocarp: &'static str,
    command: &'static str,
    input: MeshFacts,
    settings: S,
    phases: &'a Phases<T>,
    wall: f64,
    /// Bytes; 0 where the system does not tell.
    peak_rss: u64,
    #[serde(flatten)]
    engine: serde_json::Map<String, serde_json::Value>,
}

impl<'a, S, T> RunFile<'a, S, T> {
    /// The file's content; `wall` and the peak of memory are taken now.
    pub fn new(
        command: &'static str,
        input: MeshFacts,
        settings: S,
        phases: &'a Phases<T>,
        engine: &impl Serialize,
        session: &Session,
    ) -> Self {
        let mut parts = match serde_json::to_value(engine) {
            Ok(serde_json::Value::Object(parts)) => parts,
            _ => serde_json::Map::new(),
        };
        // These stand under `settings` and `phases`.
        parts.retain(|name, _| !["distance", "thickness", "voxel", "times"].contains(&name.as_str()));
        RunFile {
            exocarp: env!("CARGO_PKG_VERSION"),
            command,
            input,
            settings,
            phases,
            wall: session.wall(),
            peak_rss: peak_memory().unwrap_or(0),
            engine: parts,
        }
    }
}

/// Seconds per phase.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Phases<T> {
    #[serde(flatten)]
    pub loading: Loading,
    #[serde(flatten)]
    pub engine: T,
    pub write: f64,
}

/// Seconds to read the input.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Loading {
    pub load: f64,
    pub clean: f64,
}

/// The input as it was worked on, after cleaning; also what `exocarp info` says of a mesh.
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
    /// Of a command's input.
    pub fn of_input(path: &std::path::Path, mesh: &TriMesh, session: &Session) -> Self {
        MeshFacts::new(path, mesh, &session.run.install(|| Topology::new(mesh)))
    }

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
