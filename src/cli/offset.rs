//! `exocarp offset`: load, clean, offset, write.

use super::args::{OffsetArguments, Sign};
use super::exit::Failure;
use super::files::{
    Loaded, STORED_HALF_WIDTH, check_mesh_output, check_vdb_output, load_mesh, precision, save_json,
    save_vdb, vdb_options,
};
use super::format::{counted, grouped, short};
use super::outputs;
use super::session::{Session, Verbosity};
use super::statistics::{MeshFacts, Phases, RunFile};
use super::strategy::{Made, check_pieces, execute};
use exocarp::internals::mesh::Topology;
use exocarp::internals::offset::EngineTimes;
use exocarp::internals::run::Bytes;
use exocarp::internals::system::peak_memory;
use exocarp::io::Tile;
use exocarp::vdb::VdbOptions;
use exocarp::{BandOptions, CleanReport, OffsetError, OffsetSettings, OffsetStatistics, Phase, VoxelSize};
use serde::Serialize;

/// The usual resolution: fine enough to see the features, a second or so of work.
pub(super) const DEFAULT_RESOLUTION: u32 = 256;

/// Half-width in voxels of a band that is contoured and not stored, as the statistics file says it.
const CONTOURED_HALF_WIDTH: f64 = 1.0;

pub(super) fn run(arguments: &OffsetArguments, session: &Session) -> Result<(), Failure> {
    check_outputs(arguments)?;
    let settings = settings(arguments, session)?;

    let (loaded, loading) = load_mesh(&arguments.input, session)?;
    warn_of_input(arguments, &loaded, session);
    let result = execute(&loaded.mesh, arguments, &settings, session)?;
    if result.statistics.edges.sign_jumps > 0 {
        let jumps = counted(result.statistics.edges.sign_jumps as usize, "grid edge", "grid edges");
        session.warn(&format!("the sign jumps along {jumps}; the surface is closed there"));
    }

    if let Some(beyond) = result.statistics.contour.beyond_tolerance
        && beyond > 0
    {
        let triangles = counted(beyond as usize, "triangle", "triangles");
        session.warn(&format!("{triangles} could not be brought within the tolerance"));
    }

    warn_of_missed(&result.statistics, arguments.resolve, session);

    let (_, write) = session.phase(Phase::Write, || match (&arguments.more.vdb, &result.band) {
        (Some(path), Some(band)) => {
            let tile = arguments.tile.map(|tile| Tile::new(tile, &loaded.mesh, &settings));
            let options =
                VdbOptions { distance: Some(result.statistics.distance), ..vdb_options(&arguments.more) };
            save_vdb(band, path, tile, &options, session)
        }
        _ => Ok(()),
    })?;
    let phases = Phases { loading, engine: result.statistics.times, write: result.seconds + write };
    if let Some(path) = &arguments.more.stats {
        let input = MeshFacts::of_input(&arguments.input, &loaded.mesh, session);
        let stated = Settings::new(arguments, &settings, &result.statistics, session);
        let file = RunFile::new("offset", input, stated, &phases, &result.statistics, session);
        save_json(path, &file, session)?;
    }
    session.staging.commit()?;
    print_summary(arguments, &result, &phases, session)
}

fn settings(arguments: &OffsetArguments, session: &Session) -> Result<OffsetSettings, Failure> {
    let voxel = match arguments.voxel {
        Some(h) => VoxelSize::Units(h),
        None => VoxelSize::Resolution(arguments.resolution.unwrap_or(DEFAULT_RESOLUTION)),
    };
    let band = BandOptions { half_width: STORED_HALF_WIDTH, closest: arguments.closest };
    let settings = OffsetSettings {
        distance: arguments.distance,
        voxel,
        open_input: arguments.sign.open_input(),
        band: arguments.more.vdb.is_some().then_some(band),
        precision: precision(arguments.more.f64),
        tolerance: arguments.tolerance,
        max_halvings: arguments.resolve,
        max_memory: session.max_memory,
    };
    settings.validate().map_err(OffsetError::from)?;
    Ok(settings)
}

fn check_outputs(arguments: &OffsetArguments) -> Result<(), Failure> {
    if let Some(output) = &arguments.output {
        check_mesh_output(output, arguments.more.f64)?;
    }
    check_pieces(arguments)?;
    arguments.more.vdb.as_deref().map_or(Ok(()), check_vdb_output)?;
    outputs::check(arguments.output.iter().chain(arguments.more.files()).map(|p| p.as_path()))
}

fn warn_of_input(arguments: &OffsetArguments, loaded: &Loaded, session: &Session) {
    let shown = arguments.input.display();
    // Welding vertices and dropping idle ones changes nothing of the surface: that is for -v.
    let surface = CleanReport { welded_vertices: 0, unreferenced_vertices: 0, ..loaded.report };
    if !surface.is_clean() {
        session.warn(&format!("{shown}: {surface}"));
    }
    if arguments.sign == Sign::Closed || session.verbosity == Verbosity::Quiet {
        return;
    }
    let defects = *session.run.install(|| Topology::new(&loaded.mesh)).defects();
    if !defects.is_closed() {
        let open = counted(defects.boundary_edges, "boundary edge", "boundary edges");
        let wrong = counted(defects.misoriented_edges, "misoriented edge", "misoriented edges");
        session.warn(&format!(
            "{shown} is not the boundary of a solid ({open}, {wrong}); far from its surface inside and outside \
             are a guess"
        ));
    }
}

/// Says what the result lacks.
fn warn_of_missed(statistics: &OffsetStatistics, resolve: u32, session: &Session) {
    let missed = &statistics.missed;
    let Some(first) = missed.features.first() else { return };
    let kinds = [
        (missed.sheets, "sheet", "sheets"),
        (missed.gaps, "gap", "gaps"),
        (missed.parts, "small part", "small parts"),
    ];
    let kinds = kinds.into_iter().filter(|kind| kind.0 > 0).map(|(n, one, many)| counted(n, one, many));
    let [x, y, z] = first.at.map(short);
    let voxel = short(statistics.voxel);
    let advice = match statistics.halvings {
        0 if resolve == 0 => "choose a smaller voxel size, or --resolve".to_string(),
        0 => "a smaller voxel size would not fit".to_string(),
        n => format!("{} did not suffice", counted(n as usize, "halving", "halvings")),
    };
    session.warn(&format!(
        "the result lacks {} thinner than a voxel of {voxel}, the largest near ({x}, {y}, {z}): {advice}",
        kinds.collect::<Vec<_>>().join(", ")
    ));
}

/// The settings in the statistics file.
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

impl Settings {
    fn new(
        arguments: &OffsetArguments,
        settings: &OffsetSettings,
        engine: &OffsetStatistics,
        session: &Session,
    ) -> Self {
        let resolution = match settings.voxel {
            VoxelSize::Resolution(n) => Some(n),
            VoxelSize::Units(_) => None,
        };
        Settings {
            distance: engine.distance,
            voxel: engine.voxel,
            resolution,
            sign: arguments.sign.name(),
            threads: session.run.threads(),
            half_width: settings.band.map_or(CONTOURED_HALF_WIDTH, |band| band.half_width),
        }
    }
}

fn print_summary(
    arguments: &OffsetArguments,
    result: &Made,
    phases: &Phases<EngineTimes>,
    session: &Session,
) -> Result<(), Failure> {
    let s = &result.statistics;
    let what = match &arguments.output {
        Some(_) => {
            let triangles = counted(s.contour.triangles as usize, "triangle", "triangles");
            let vertices = counted(s.contour.vertices as usize, "vertex", "vertices");
            let slabs = match (arguments.tile, s.slabs) {
                (Some(tile), _) => format!(" in tile {} of {}", tile.index(), tile.count()),
                (None, 0 | 1) => String::new(),
                (None, slabs) => format!(" in {slabs} slabs"),
            };
            format!("{triangles}, {vertices}{slabs}")
        }
        None => counted(s.vdb.active_voxels as usize, "active voxel", "active voxels"),
    };
    let mut files = arguments.output.iter().chain(arguments.more.files());
    let first = files.next().map(|path| path.display().to_string()).unwrap_or_default();
    let more: String = files.map(|path| format!("; {}", path.display())).collect();
    session.print_result(&format!("{first}: {what}, {:.2} s{more}", session.wall()))?;
    match session.verbosity {
        Verbosity::Verbose => session.print_result(&summary(result, phases)),
        _ => Ok(()),
    }
}

/// Phases and counts.
fn summary(result: &Made, phases: &Phases<EngineTimes>) -> String {
    let s = &result.statistics;
    let seconds = |name: &str, t: f64| format!("  {name:<10} {t:>8.3} s\n");
    let count = |name: &str, n: u64| format!("  {name:<28} {:>14}\n", grouped(n));
    let mut text = format!("  distance {}, voxel size {}\n", short(s.distance), short(s.voxel));
    text += &seconds("load", phases.loading.load);
    text += &seconds("clean", phases.loading.clean);
    text += &seconds("hierarchy", s.times.hierarchy);
    text += &seconds("band", s.times.band);
    text += &seconds("edges", s.times.edges);
    text += &seconds("contour", s.times.contour);
    text += &seconds("write", phases.write);
    text += &count("grid nodes", s.filter.nodes_total);
    let queries = s.filter.bounding_box_queries
        + s.filter.octree_queries_valid
        + s.filter.octree_queries_invalid
        + s.filter.node_queries;
    text += &count("distances in the filters", queries);
    text += &count("valid nodes", s.filter.valid_nodes);
    text += &count("intersected edges", s.edges.intersected);
    text += &count("  solved by bisection", s.edges.bisected);
    text += &count("cells", s.contour.cells);
    text += &count("  with several sheets", s.contour.several_sheets);
    text += &count("  clamped vertices", s.contour.clamped);
    text += &count("active voxels", s.vdb.active_voxels);
    text + &format!("  band {}, peak {}", Bytes(s.vdb.memory), Bytes(peak_memory().unwrap_or(0)))
}
