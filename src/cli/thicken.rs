//! `exocarp thicken`: load, clean, thicken, write.

use super::args::ThickenArguments;
use super::exit::{Failure, of_io};
use super::numbers::{counted, grouped, short};
use super::offset::{
    STORED_HALF_WIDTH, check_mesh_output, check_vdb_output, coordinates, load_mesh, precision, save_mesh,
    save_vdb, vdb_options,
};
use super::outputs;
use super::resources::peak_rss;
use super::session::{Session, Verbosity};
use super::statistics::MeshFacts;
use super::thickness_map;
use exocarp::mesh::{CleanReport, Topology};
use exocarp::offset::{Length, OffsetSettings, VoxelSize, offset_band};
use exocarp::run::Phase;
use exocarp::thicken::{ThickenResult, ThickenSettings, ThickenStatistics, ThickenTimes, thicken};
use exocarp::vdb::Band;
use serde::Serialize;
use std::path::Path;

pub(super) fn run(arguments: &ThickenArguments, session: &Session) -> Result<(), Failure> {
    check_mesh_output(&arguments.output, arguments.f64)?;
    arguments.vdb.as_deref().map_or(Ok(()), check_vdb_output)?;
    let written = std::iter::once(&arguments.output).chain(&arguments.vdb).chain(&arguments.stats);
    outputs::check(written.map(|p| p.as_path()))?;
    let mut settings = settings(arguments)?;

    let (loaded, loading) = load_mesh(&arguments.input, session)?;
    if let Some(path) = &arguments.thickness_map {
        settings.map = Some(thickness_map::load(path, &arguments.input, &loaded.mesh)?);
    }
    let surface = CleanReport { welded_vertices: 0, unreferenced_vertices: 0, ..loaded.report };
    if !surface.is_clean() {
        session.warn(&format!("{}: {surface}", arguments.input.display()));
    }
    let result = thicken(&loaded.mesh, &settings, &session.run)?;
    let statistics = &result.statistics;
    if statistics.halvings > 0 {
        session.warn(&format!(
            "the lattice was too coarse for the patch; the voxel size was halved {} to {}",
            counted(statistics.halvings as usize, "time", "times"),
            short(statistics.voxel)
        ));
    }
    let (_, write) = session.phase(Phase::Write, || {
        save_mesh(&result.mesh, &arguments.output, coordinates(arguments.f64), session)?;
        arguments.vdb.as_deref().map_or(Ok(()), |path| save_level_set(&result, path, arguments, session))
    })?;
    let phases = Phases { load: loading.load, clean: loading.clean, engine: statistics.times, write };
    if let Some(path) = &arguments.stats {
        let topology = session.run.install(|| Topology::new(&loaded.mesh));
        let facts = MeshFacts::new(&arguments.input, &loaded.mesh, &topology);
        save_statistics(path, arguments, &facts, statistics, &phases, session)?;
    }
    session.staging.commit()?;
    tell(arguments, &result, &phases, session);
    Ok(())
}

/// Writes the solid as a level set: the signed distance from its boundary.
fn save_level_set(
    result: &ThickenResult,
    path: &Path,
    arguments: &ThickenArguments,
    session: &Session,
) -> Result<(), Failure> {
    let settings = OffsetSettings {
        distance: Length::Units(0.0),
        voxel: VoxelSize::Units(result.statistics.voxel),
        half_width: STORED_HALF_WIDTH,
        keep_band: true,
        max_memory: session.max_memory,
        ..OffsetSettings::default()
    };
    let solid = offset_band(&result.mesh, &settings, &session.run)?;
    let options = vdb_options(arguments.vdb_compression, arguments.half, arguments.unit.as_ref());
    // Closest triangles would be those of the solid, which is another file.
    let band = solid.band.map(|band| Band { closest: None, ..band });
    band.map_or(Ok(()), |band| save_vdb(&band, path, None, &options, session))
}

fn settings(arguments: &ThickenArguments) -> Result<ThickenSettings, Failure> {
    let voxel = match (arguments.voxel, arguments.resolution) {
        (Some(h), _) => Some(VoxelSize::Units(h)),
        (None, Some(n)) => Some(VoxelSize::Resolution(n)),
        (None, None) => None,
    };
    let defaults = ThickenSettings::default();
    let settings = ThickenSettings {
        thickness: arguments.thickness.unwrap_or(defaults.thickness),
        side: arguments.side.side(),
        voxel,
        halvings: arguments.resolve,
        precision: precision(&arguments.output, arguments.f64)?,
        ..defaults
    };
    settings.validate().map_err(exocarp::error::Error::from)?;
    Ok(settings)
}

/// Seconds per phase.
#[derive(Clone, Copy, Debug, Serialize)]
struct Phases {
    load: f64,
    clean: f64,
    #[serde(flatten)]
    engine: ThickenTimes,
    write: f64,
}

/// Everything about one run.
#[derive(Debug, Serialize)]
struct ThickenFile<'a> {
    exocarp: &'static str,
    command: &'static str,
    input: &'a MeshFacts,
    settings: Settings,
    phases: &'a Phases,
    wall: f64,
    /// Bytes; 0 where the system does not tell.
    peak_rss: u64,
    halvings: u32,
    triangles: exocarp::thicken::TriangleCounts,
}

#[derive(Debug, Serialize)]
struct Settings {
    thickness: f64,
    side: &'static str,
    voxel: f64,
    /// `null` when the voxel size was given or follows from the thickness.
    resolution: Option<u32>,
    threads: usize,
}

fn save_statistics(
    output: &Path,
    arguments: &ThickenArguments,
    input: &MeshFacts,
    statistics: &ThickenStatistics,
    phases: &Phases,
    session: &Session,
) -> Result<(), Failure> {
    let staged = session.staging.stage(output)?;
    let write = || -> std::io::Result<()> {
        let file = ThickenFile {
            exocarp: env!("CARGO_PKG_VERSION"),
            command: "thicken",
            input,
            settings: Settings {
                thickness: statistics.thickness,
                side: arguments.side.name(),
                voxel: statistics.voxel,
                resolution: arguments.resolution,
                threads: session.run.threads(),
            },
            phases,
            wall: session.wall(),
            peak_rss: peak_rss(),
            halvings: statistics.halvings,
            triangles: statistics.triangles,
        };
        std::fs::write(&staged, serde_json::to_string_pretty(&file)? + "\n")
    };
    write().map_err(|error| {
        Failure::new(of_io(&error), format!("{} cannot be written ({error})", output.display()))
    })
}

fn tell(arguments: &ThickenArguments, result: &ThickenResult, phases: &Phases, session: &Session) {
    let more: String =
        arguments.vdb.iter().chain(&arguments.stats).map(|path| format!("; {}", path.display())).collect();
    session.tell(&format!(
        "{}: {}, {}, {:.2} s{more}",
        arguments.output.display(),
        counted(result.mesh.triangles.len(), "triangle", "triangles"),
        counted(result.mesh.vertices.len(), "vertex", "vertices"),
        session.wall(),
    ));
    if session.verbosity == Verbosity::Verbose {
        let s = &result.statistics;
        let seconds = |name: &str, t: f64| format!("  {name:<10} {t:>8.3} s\n");
        let count = |name: &str, n: u64| format!("  {name:<28} {:>14}\n", grouped(n));
        let mut text = format!("  thickness {}, voxel size {}\n", short(s.thickness), short(s.voxel));
        for (name, time) in [
            ("load", phases.load),
            ("clean", phases.clean),
            ("hierarchy", s.times.hierarchy),
            ("nodes", s.times.nodes),
            ("faces", s.times.faces),
            ("boundary", s.times.boundary),
            ("shape", s.times.shape),
            ("write", phases.write),
        ] {
            text += &seconds(name, time);
        }
        text += &count("triangles kept", s.triangles.kept);
        text += &count("triangles split", s.triangles.split);
        text += &count("triangles new", s.triangles.new);
        session.tell(&text);
    }
}
