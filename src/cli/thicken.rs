//! `exocarp thicken`: load, clean, thicken, write.

use super::args::ThickenArguments;
use super::exit::Failure;
use super::files::{
    STORED_HALF_WIDTH, check_mesh_output, check_vdb_output, load_mesh, precision, save_json, save_mesh,
    save_vdb, vdb_options,
};
use super::format::{counted, grouped, short};
use super::outputs;
use super::session::{Session, Verbosity};
use super::statistics::{MeshFacts, Phases, RunFile};
use super::thickness_map;
use exocarp::internals::thicken::ThickenStatistics;
use exocarp::internals::thicken::ThickenTimes;
use exocarp::{
    BandOptions, CleanReport, Length, OffsetSettings, Phase, ThickenError, ThickenResult, ThickenSettings,
    VoxelSize, offset_band, thicken,
};
use serde::Serialize;
use std::path::Path;

pub(super) fn run(arguments: &ThickenArguments, session: &Session) -> Result<(), Failure> {
    check_mesh_output(&arguments.output, arguments.more.f64)?;
    arguments.more.vdb.as_deref().map_or(Ok(()), check_vdb_output)?;
    outputs::check(std::iter::once(&arguments.output).chain(arguments.more.files()).map(|p| p.as_path()))?;
    let mut settings = settings(arguments, session)?;

    let (loaded, loading) = load_mesh(&arguments.input, session)?;
    if let Some(path) = &arguments.thickness_map {
        settings.thickness_map = Some(thickness_map::load(path, &arguments.input, &loaded.mesh)?);
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
    if !statistics.capped.is_empty() {
        session.warn(&format!(
            "{} too narrow for voxels of {} closed, the first one near ({}); a smaller voxel size keeps what it can wall",
            counted(statistics.capped.len(), "hole is", "holes are"),
            short(statistics.voxel),
            statistics.capped[0].map(short).join(", ")
        ));
    }
    let (_, write) = session.phase(Phase::Write, || {
        save_mesh(&result.mesh, &arguments.output, precision(arguments.more.f64), session)?;
        arguments.more.vdb.as_deref().map_or(Ok(()), |path| save_level_set(&result, path, arguments, session))
    })?;
    let phases = Phases { loading, engine: statistics.times, write };
    if let Some(path) = &arguments.more.stats {
        let input = MeshFacts::of_input(&arguments.input, &loaded.mesh, session);
        let stated = Settings::new(arguments, statistics, session);
        save_json(path, &RunFile::new("thicken", input, stated, &phases, statistics, session), session)?;
    }
    session.staging.commit()?;
    print_summary(arguments, &result, &phases, session)
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
        band: Some(BandOptions { half_width: STORED_HALF_WIDTH, closest: false }),
        max_memory: session.max_memory,
        ..OffsetSettings::default()
    };
    let solid = offset_band(&result.mesh, &settings, &session.run)?;
    save_vdb(&solid.band, path, None, &vdb_options(&arguments.more), session)
}

fn settings(arguments: &ThickenArguments, session: &Session) -> Result<ThickenSettings, Failure> {
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
        max_halvings: arguments.resolve,
        rounds: arguments.rounds,
        section_normals: arguments.section_normals.normals(),
        precision: precision(arguments.more.f64),
        max_memory: session.max_memory,
        ..defaults
    };
    settings.validate().map_err(ThickenError::from)?;
    Ok(settings)
}

/// The settings in the statistics file.
#[derive(Debug, Serialize)]
struct Settings {
    thickness: f64,
    side: &'static str,
    voxel: f64,
    /// `null` when the voxel size was given or follows from the thickness.
    resolution: Option<u32>,
    rounds: u32,
    threads: usize,
}

impl Settings {
    fn new(arguments: &ThickenArguments, engine: &ThickenStatistics, session: &Session) -> Self {
        Settings {
            thickness: engine.thickness,
            side: arguments.side.name(),
            voxel: engine.voxel,
            resolution: arguments.resolution,
            rounds: arguments.rounds,
            threads: session.run.threads(),
        }
    }
}

fn print_summary(
    arguments: &ThickenArguments,
    result: &ThickenResult,
    phases: &Phases<ThickenTimes>,
    session: &Session,
) -> Result<(), Failure> {
    let more: String = arguments.more.files().map(|path| format!("; {}", path.display())).collect();
    session.print_result(&format!(
        "{}: {}, {}, {:.2} s{more}",
        arguments.output.display(),
        counted(result.mesh.triangles.len(), "triangle", "triangles"),
        counted(result.mesh.vertices.len(), "vertex", "vertices"),
        session.wall(),
    ))?;
    if session.verbosity == Verbosity::Verbose {
        let s = &result.statistics;
        let seconds = |name: &str, t: f64| format!("  {name:<10} {t:>8.3} s\n");
        let count = |name: &str, n: u64| format!("  {name:<28} {:>14}\n", grouped(n));
        let mut text = format!("  thickness {}, voxel size {}\n", short(s.thickness), short(s.voxel));
        for (name, time) in [
            ("load", phases.loading.load),
            ("clean", phases.loading.clean),
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
        session.print_result(&text)?;
    }
    Ok(())
}
