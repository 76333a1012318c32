//! `exocarp info`: what a mesh or a `.vdb` file holds.

use super::args::InfoArguments;
use super::exit::Failure;
use super::files::{check_input, load_mesh};
use super::format::{grouped, short};
use super::session::{Session, print};
use super::statistics::MeshFacts;
use exocarp::internals::mesh::{Defects, Topology, measure};
use exocarp::internals::vdb::GridInfo;
use exocarp::vdb::FileInfo;
use exocarp::{CleanReport, Phase};
use serde::Serialize;
use serde_json::{Value, json};

pub(super) fn run(arguments: &InfoArguments, session: &Session) -> Result<(), Failure> {
    let is_vdb = arguments.file.extension().is_some_and(|e| e.eq_ignore_ascii_case("vdb"));
    let (text, json) = if is_vdb {
        check_input(&arguments.file)?;
        let (info, _) = session.phase(Phase::Load, || Ok(FileInfo::read(&arguments.file)?))?;
        (vdb_text(&info), vdb_json(&info))
    } else {
        let facts = mesh_facts(arguments, session)?;
        (facts.text(), serde_json::to_value(&facts).unwrap_or(Value::Null))
    };
    match arguments.json {
        true => print(&format!("{json:#}")),
        false => print(&format!("{}\n{text}", arguments.file.display())),
    }
}

/// A mesh after cleaning, and what cleaning did.
#[derive(Debug, Serialize)]
struct Facts {
    #[serde(flatten)]
    mesh: MeshFacts,
    area: f64,
    /// `None` for a mesh that is not closed.
    volume: Option<f64>,
    boundary_edges: usize,
    misoriented_edges: usize,
    non_manifold_edges: usize,
    cleaned: CleanReport,
}

fn mesh_facts(arguments: &InfoArguments, session: &Session) -> Result<Facts, Failure> {
    let (loaded, _) = load_mesh(&arguments.file, session)?;
    let (mesh, topology) = (&loaded.mesh, session.run.install(|| Topology::new(&loaded.mesh)));
    let facts = MeshFacts::new(&arguments.file, mesh, &topology);
    let Defects { boundary_edges, misoriented_edges, non_manifold_edges, .. } = *topology.defects();
    Ok(Facts {
        area: measure::area(mesh),
        volume: facts.closed.then(|| measure::signed_volume(mesh)),
        mesh: facts,
        boundary_edges,
        misoriented_edges,
        non_manifold_edges,
        cleaned: loaded.report,
    })
}

impl Facts {
    fn text(&self) -> String {
        let [lo, hi] = self.mesh.bbox;
        let count = |n: usize| grouped(n as u64);
        let yes = |b: bool| if b { "yes" } else { "no" }.to_string();
        table(&[
            ("vertices", count(self.mesh.vertices)),
            ("triangles", count(self.mesh.triangles)),
            ("components", count(self.mesh.components)),
            ("bounding box", format!("{} to {}", point(lo), point(hi))),
            ("size", point(std::array::from_fn(|a| hi[a] - lo[a]))),
            ("diagonal", short(self.mesh.diagonal)),
            ("area", short(self.area)),
            ("volume", self.volume.map_or("none, it is not closed".into(), short)),
            ("closed", yes(self.mesh.closed)),
            ("boundary edges", count(self.boundary_edges)),
            ("misoriented edges", count(self.misoriented_edges)),
            ("non-manifold edges", count(self.non_manifold_edges)),
            ("cleaned", self.cleaned.to_string()),
        ])
    }
}

fn point(p: [f64; 3]) -> String {
    format!("({}, {}, {})", short(p[0]), short(p[1]), short(p[2]))
}

fn table(rows: &[(&str, String)]) -> String {
    rows.iter().map(|(name, value)| format!("  {name:<18}  {value}\n")).collect()
}

fn vdb_text(info: &FileInfo) -> String {
    let mut rows = vec![("file format", info.format.to_string()), ("library", info.library.clone())];
    rows.extend(info.metadata.iter().map(|(name, value)| (name.as_str(), value.clone())));
    let mut text = table(&rows);
    for grid in &info.grids {
        text += &format!("grid {:?}\n{}", grid.name, grid_text(grid));
    }
    text
}

fn grid_text(grid: &GridInfo) -> String {
    let bbox = |lo: String, hi: String| format!("{lo} to {hi}");
    let empty = || "empty".to_string();
    table(&[
        ("type", grid.value_type.clone()),
        ("class", grid.class.clone()),
        (
            "voxel size",
            match grid.voxel {
                [x, y, z] if x == y && y == z => short(x),
                voxel => point(voxel),
            },
        ),
        ("translation", point(grid.translation)),
        ("background", grid.background.clone()),
        ("active voxels", grouped(grid.active_voxels)),
        (
            "index box",
            grid.index_bbox.map_or_else(empty, |[lo, hi]| bbox(format!("{:?}", lo.0), format!("{:?}", hi.0))),
        ),
        ("world box", grid.world_bbox.map_or_else(empty, |[lo, hi]| bbox(point(lo), point(hi)))),
    ])
}

fn vdb_json(info: &FileInfo) -> Value {
    let object = |pairs: &[(String, String)]| -> Value {
        pairs.iter().map(|(name, value)| (name.clone(), Value::from(value.clone()))).collect()
    };
    let grids: Vec<Value> = info
        .grids
        .iter()
        .map(|grid| {
            json!({
                "name": grid.name,
                "type": grid.value_type,
                "class": grid.class,
                "voxel": grid.voxel,
                "translation": grid.translation,
                "background": grid.background,
                "active_voxels": grid.active_voxels,
                "index_bbox": grid.index_bbox.map(|b| b.map(|p| p.0)),
                "world_bbox": grid.world_bbox,
                "metadata": object(&grid.metadata),
            })
        })
        .collect();
    json!({
        "format": info.format,
        "library": info.library,
        "metadata": object(&info.metadata),
        "grids": grids,
    })
}
