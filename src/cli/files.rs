//! Files that commands read and write: meshes, level sets, JSON.

use super::args::{Codec, OutputArguments};
use super::exit::{Exit, Failure, of_io};
use super::session::Session;
use super::statistics::Loading;
use exocarp::io::{self, Format, SaveOptions, Tile};
use exocarp::vdb::Band;
use exocarp::vdb::{Compression, VdbError, VdbOptions, VdbPrecision};
use exocarp::{CleanReport, Phase, Precision, TriMesh, clean};
use serde::Serialize;
use std::path::Path;

/// Half-width in voxels of a band that other programs will read: OpenVDB's own default, and the
/// least that its level-set checks accept.
pub(super) const STORED_HALF_WIDTH: f64 = 3.0;

/// The coordinates that the output will have: the promise of no intersections holds for those.
pub(super) fn precision(f64: bool) -> Precision {
    if f64 { Precision::F64 } else { Precision::F32 }
}

pub(super) fn format(output: &Path) -> Result<Format, Failure> {
    if output == Path::new("-") {
        return Err(Failure::usage("standard output takes no meshes; name a file"));
    }
    Format::of(output).map_err(|e| Failure::usage(format!("{}: {e}", output.display())))
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
            "{shown}: STL has no 64-bit coordinates; write .ply, .obj or .off, or omit --f64"
        )));
    }
    Ok(())
}

/// A mesh ready for work.
#[derive(Debug)]
pub(super) struct Loaded {
    pub mesh: TriMesh,
    pub report: CleanReport,
}

/// Loads and cleans a mesh, and says how long both took.
pub(super) fn load_mesh(path: &Path, session: &Session) -> Result<(Loaded, Loading), Failure> {
    let (mesh, load) = load_as_it_stands(path, session)?;
    let ((mesh, report), clean) = session.phase(Phase::Clean, || Ok(session.run.install(|| clean(mesh))))?;
    Ok((Loaded { mesh, report }, Loading { load, clean }))
}

/// Loads a mesh, warns of what was passed over in the file, and says how long it took.
pub(super) fn load_as_it_stands(path: &Path, session: &Session) -> Result<(TriMesh, f64), Failure> {
    let load = || Ok(session.run.install(|| io::load_with_notes(path))?);
    let (io::Loaded { mesh, notes, .. }, seconds) = session.phase(Phase::Load, load)?;
    for note in notes {
        session.warn(&note.to_string());
    }
    Ok((mesh, seconds))
}

/// Refuses an input that is no file before it is opened: opening a pipe would wait for who writes
/// to it.
pub(super) fn check_input(path: &Path) -> Result<(), Failure> {
    let refuse = |what: &str| {
        Err(Failure::new(Exit::Input, format!("{}: {what}; save it as a file and name that", path.display())))
    };
    match std::fs::metadata(path) {
        _ if path == Path::new("-") => refuse("standard input is not read"),
        Ok(meta) if !meta.is_file() && !meta.is_dir() => refuse("this is a pipe or a device"),
        // What is missing or a directory is found out where it is read.
        _ => Ok(()),
    }
}

/// Writes a mesh to where it will be put in place from.
pub(super) fn save_mesh(
    mesh: &TriMesh,
    output: &Path,
    precision: Precision,
    session: &Session,
) -> Result<(), Failure> {
    let staged = session.staging.stage(output)?;
    io::save(mesh, &staged, &SaveOptions { precision }).map_err(|mut error| {
        // The user knows nothing of the temporary path.
        error.path = output.into();
        error.into()
    })
}

/// Returns the options of a `.vdb` file.
pub(super) fn vdb_options(arguments: &OutputArguments) -> VdbOptions {
    VdbOptions {
        compression: match arguments.vdb_compression {
            Codec::Blosc => Compression::Blosc,
            Codec::Zip => Compression::Zip,
            Codec::None => Compression::None,
        },
        precision: if arguments.half { VdbPrecision::Half } else { VdbPrecision::Full },
        unit: arguments.unit.clone(),
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
        Some(tile) => band.save_tile(&staged, tile, options),
        None => band.save(&staged, options),
    };
    written.map_err(|error| match error {
        VdbError::Write { reason, source, .. } => {
            VdbError::Write { path: output.into(), reason, source }.into()
        }
        other => other.into(),
    })
}

/// Writes text to where it will be put in place from.
pub(super) fn save_text(output: &Path, text: &str, session: &Session) -> Result<(), Failure> {
    let staged = session.staging.stage(output)?;
    std::fs::write(&staged, text).map_err(|error| {
        Failure::new(of_io(&error), format!("{} cannot be written ({error})", output.display()))
    })
}

/// Writes JSON to where it will be put in place from.
pub(super) fn save_json(output: &Path, value: &impl Serialize, session: &Session) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::new(Exit::Internal, error.to_string()))?;
    save_text(output, &(json + "\n"), session)
}
