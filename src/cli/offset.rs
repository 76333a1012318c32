//! `exocarp offset`: load, clean, offset, write.

use super::args::{Codec, OffsetArguments, Sign, TileNumber};
use super::exit::{Failure, of_io};
use super::making::{check_pieces, identity, make};
use super::numbers::{counted, grouped, memory, short};
use super::outputs;
use super::resources::peak_rss;
use super::session::{Session, Verbosity};
use super::statistics::{MeshFacts, OffsetFile, Phases};
use exocarp::io::{self, Coordinates, Format, SaveOptions, Tile};
use exocarp::mesh::{CleanReport, Topology, TriMesh, clean};
use exocarp::offset::{OffsetResult, OffsetSettings, OffsetStatistics, Precision, VoxelSize};
use exocarp::run::Phase;
use exocarp::vdb::{self, Band, Compression, VdbError, VdbOptions, VdbPrecision};
use std::path::Path;

/// Half-width in voxels of a band that other programs will read: OpenVDB's own default, and the least that
/// its level-set checks accept.
pub(super) const STORED_HALF_WIDTH: f64 = 3.0;

/// The usual resolution: fine enough to see the features, a second or so of work.
pub(super) const DEFAULT_RESOLUTION: u32 = 256;

pub(super) fn run(arguments: &OffsetArguments, session: &Session) -> Result<(), Failure> {
    check_outputs(arguments)?;
    let settings = settings(arguments, session)?;

    let (loaded, mut phases) = load_mesh(&arguments.input, session)?;
    warn_of_input(arguments, &loaded, session);
    let (result, written) = make(&loaded.mesh, arguments, &settings, session)?;
    phases.engine = result.statistics.times;
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

    warn_of_unseen(&result.statistics, arguments.resolve, session);

    let (_, write) = session.phase(Phase::Write, || match (&arguments.vdb, &result.band) {
        (Some(path), Some(band)) => {
            let tile = arguments.tile.map(|tile| identity(tile, &loaded.mesh, &settings));
            let stored = vdb_options(arguments.vdb_compression, arguments.half, arguments.unit.as_ref());
            let options = VdbOptions { distance: Some(result.statistics.distance), ..stored };
            save_vdb(band, path, tile, &options, session)
        }
        _ => Ok(()),
    })?;
    phases.write = written + write;
    if let Some(path) = &arguments.stats {
        save_statistics(path, arguments, &settings, &loaded, &result, &phases, session)?;
    }
    session.staging.commit()?;
    tell(arguments, &result, &phases, session);
    Ok(())
}

fn settings(arguments: &OffsetArguments, session: &Session) -> Result<OffsetSettings, Failure> {
    let voxel = match arguments.voxel {
        Some(h) => VoxelSize::Units(h),
        None => VoxelSize::Resolution(arguments.resolution.unwrap_or(DEFAULT_RESOLUTION)),
    };
    let settings = OffsetSettings {
        distance: arguments.distance,
        voxel,
        sign: arguments.sign.mode(),
        half_width: if arguments.vdb.is_some() { STORED_HALF_WIDTH } else { 1.0 },
        keep_band: arguments.vdb.is_some(),
        precision: arguments.output.as_ref().map_or(Ok(Precision::F32), |o| precision(o, arguments.f64))?,
        tolerance: arguments.tolerance,
        resolve: arguments.resolve,
        max_memory: session.max_memory,
    };
    settings.validate().map_err(exocarp::error::Error::from)?;
    Ok(settings)
}

/// The coordinates that the output will have: the promise of no intersections holds for those.
pub(super) fn precision(output: &Path, f64: bool) -> Result<Precision, Failure> {
    Ok(match format(output)? {
        Format::Obj | Format::Off => Precision::F64,
        Format::Ply if f64 => Precision::F64,
        Format::Ply | Format::Stl => Precision::F32,
    })
}

pub(super) fn format(output: &Path) -> Result<Format, Failure> {
    Format::of(output).map_err(|e| Failure::usage(format!("{}: {e}", output.display())))
}

fn check_outputs(arguments: &OffsetArguments) -> Result<(), Failure> {
    if let Some(output) = &arguments.output {
        check_mesh_output(output, arguments.f64)?;
    }
    check_pieces(arguments)?;
    arguments.vdb.as_deref().map_or(Ok(()), check_vdb_output)?;
    let all = [&arguments.output, &arguments.vdb, &arguments.stats];
    outputs::check(all.into_iter().flatten().map(|p| p.as_path()))
}

/// Whether a file's name ends in `.vdb`.
pub(super) fn is_vdb(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("vdb"))
}

/// Checks that the extension of a mesh output is known and can hold what was asked for.
pub(super) fn check_mesh_output(output: &Path, f64: bool) -> Result<(), Failure> {
    if format(output)? == Format::Stl && f64 {
        let shown = output.display();
        return Err(Failure::usage(format!(
            "{shown}: STL has no 64-bit coordinates; write .ply, or omit --f64"
        )));
    }
    Ok(())
}

pub(super) fn coordinates(f64: bool) -> Coordinates {
    if f64 { Coordinates::F64 } else { Coordinates::F32 }
}

/// A mesh ready for work.
#[derive(Debug)]
pub(super) struct Loaded {
    pub mesh: TriMesh,
    pub report: CleanReport,
}

/// Loads and cleans a mesh, and says how long both took.
pub(super) fn load_mesh(path: &Path, session: &Session) -> Result<(Loaded, Phases), Failure> {
    let (mesh, load) = session.phase(Phase::Load, || Ok(session.run.install(|| io::load(path))?))?;
    let ((mesh, report), clean) = session.phase(Phase::Clean, || Ok(session.run.install(|| clean(mesh))))?;
    Ok((Loaded { mesh, report }, Phases { load, clean, ..Phases::default() }))
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
fn warn_of_unseen(statistics: &OffsetStatistics, resolve: u32, session: &Session) {
    let unseen = &statistics.unseen;
    let Some(first) = unseen.places.first() else { return };
    let kinds = [
        (unseen.sheets, "sheet", "sheets"),
        (unseen.gaps, "gap", "gaps"),
        (unseen.parts, "small part", "small parts"),
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

/// Writes a mesh to where it will be put in place from.
pub(super) fn save_mesh(
    mesh: &TriMesh,
    output: &Path,
    coordinates: Coordinates,
    session: &Session,
) -> Result<(), Failure> {
    let staged = session.staging.stage(output)?;
    io::save(mesh, &staged, &SaveOptions { coordinates }).map_err(|mut error| {
        // The user knows nothing of the temporary path.
        error.path = output.into();
        error.into()
    })
}

/// How a band is stored.
pub(super) fn vdb_options(codec: Codec, half: bool, unit: Option<&String>) -> VdbOptions {
    VdbOptions {
        compression: match codec {
            Codec::Blosc => Compression::Blosc,
            Codec::Zip => Compression::Zip,
            Codec::None => Compression::None,
        },
        precision: if half { VdbPrecision::Half } else { VdbPrecision::Full },
        unit: unit.cloned(),
        ..VdbOptions::default()
    }
}

/// Checks that a level set's file is named as one.
pub(super) fn check_vdb_output(path: &Path) -> Result<(), Failure> {
    if is_vdb(path) {
        return Ok(());
    }
    Err(Failure::usage(format!("{}: --vdb needs a file name that ends in .vdb", path.display())))
}

/// Writes a band to where it will be put in place from.
pub(super) fn save_vdb(
    band: &Band,
    output: &Path,
    tile: Option<Tile>,
    options: &VdbOptions,
    session: &Session,
) -> Result<(), Failure> {
    session.run.check()?;
    let staged = session.staging.stage(output)?;
    let written = match tile {
        Some(tile) => vdb::write_tile(&staged, band, tile, options),
        None => vdb::write(&staged, &band.surface, band.closest.as_ref(), options),
    };
    written.map_err(|error| match error {
        VdbError::Write { reason, .. } => VdbError::Write { path: output.into(), reason }.into(),
        other => other.into(),
    })
}

fn save_statistics(
    output: &Path,
    arguments: &OffsetArguments,
    settings: &OffsetSettings,
    loaded: &Loaded,
    result: &OffsetResult,
    phases: &Phases,
    session: &Session,
) -> Result<(), Failure> {
    let staged = session.staging.stage(output)?;
    let topology = session.run.install(|| Topology::new(&loaded.mesh));
    let facts = MeshFacts::new(&arguments.input, &loaded.mesh, &topology);
    let write = || -> std::io::Result<()> {
        let file = OffsetFile::new(arguments, settings, &facts, &result.statistics, phases, session)?;
        std::fs::write(&staged, serde_json::to_string_pretty(&file)? + "\n")
    };
    write().map_err(|error| {
        Failure::new(of_io(&error), format!("{} cannot be written ({error})", output.display()))
    })
}

fn tell(arguments: &OffsetArguments, result: &OffsetResult, phases: &Phases, session: &Session) {
    let s = &result.statistics;
    let what = match &arguments.output {
        Some(_) => {
            let triangles = counted(s.contour.triangles as usize, "triangle", "triangles");
            let vertices = counted(s.contour.vertices as usize, "vertex", "vertices");
            let slabs = match (arguments.tile, s.slabs) {
                (Some(TileNumber { number, of }), _) => format!(" in tile {number} of {of}"),
                (None, 0 | 1) => String::new(),
                (None, slabs) => format!(" in {slabs} slabs"),
            };
            format!("{triangles}, {vertices}{slabs}")
        }
        None => counted(s.vdb.active_voxels as usize, "active voxel", "active voxels"),
    };
    let mut files = [&arguments.output, &arguments.vdb, &arguments.stats].into_iter().flatten();
    let first = files.next().map(|path| path.display().to_string()).unwrap_or_default();
    let more: String = files.map(|path| format!("; {}", path.display())).collect();
    session.tell(&format!("{first}: {what}, {:.2} s{more}", session.wall()));
    if session.verbosity == Verbosity::Verbose {
        session.tell(&summary(result, phases));
    }
}

/// Phases and counts.
fn summary(result: &OffsetResult, phases: &Phases) -> String {
    let s = &result.statistics;
    let seconds = |name: &str, t: f64| format!("  {name:<10} {t:>8.3} s\n");
    let count = |name: &str, n: u64| format!("  {name:<28} {:>14}\n", grouped(n));
    let mut text = format!("  distance {}, voxel size {}\n", short(s.distance), short(s.voxel));
    text += &seconds("load", phases.load);
    text += &seconds("clean", phases.clean);
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
    text + &format!("  band {}, peak {}", memory(s.vdb.memory), memory(peak_rss()))
}
