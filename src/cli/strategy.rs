//! The ways to make an offset: as a whole, slab by slab, one tile of it, or its band only.

use super::args::{OffsetArguments, TileNumber};
use super::exit::Failure;
use super::files::{coordinates, format, save_mesh};
use super::session::Session;
use exocarp::contour::SlabContour;
use exocarp::io::{Format, MeshStream, SaveError, Tile, save_tile};
use exocarp::mesh::TriMesh;
use exocarp::offset::{
    Cut, OffsetError, OffsetResult, OffsetSettings, PieceSink, SinkError, available_memory, job, offset,
    offset_band, offset_in_slabs,
};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Memory of a streamed run where no limit is given: 1 GiB.
const STREAM_MEMORY: u64 = 1 << 30;

/// A way to make an offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// All at once, or slab by slab within so many bytes where that does not fit.
    Whole { or_slabs: Option<u64> },
    /// Slab by slab, within so many bytes.
    Slabs(u64),
    /// One tile.
    Tile(TileNumber),
}

/// Makes the offset and stages its mesh. Returns with it the seconds that writing took.
pub(super) fn make(
    mesh: &TriMesh,
    arguments: &OffsetArguments,
    settings: &OffsetSettings,
    session: &Session,
) -> Result<(OffsetResult, f64), Failure> {
    let run = &session.run;
    let Some(output) = &arguments.output else {
        return Ok((offset_band(mesh, settings, run)?, 0.0));
    };
    match way(arguments, output, session)? {
        Way::Whole { or_slabs } => {
            let result = match (offset(mesh, settings, run), or_slabs) {
                (Err(OffsetError::Memory(_)), Some(memory)) => {
                    return in_slabs(mesh, arguments, settings, memory, output, session);
                }
                (result, _) => result?,
            };
            let started = Instant::now();
            save_mesh(&result.mesh, output, coordinates(arguments.more.f64), session)?;
            Ok((result, started.elapsed().as_secs_f64()))
        }
        Way::Slabs(memory) => in_slabs(mesh, arguments, settings, memory, output, session),
        Way::Tile(TileNumber { number, of }) => {
            let staged = session.staging.stage(output)?;
            let tile = identity(TileNumber { number, of }, mesh, settings);
            let mut sink = Tiled { staged, tile, f64: arguments.more.f64, seconds: 0.0 };
            let result = offset_in_slabs(mesh, settings, Cut::Tile { number, of }, &mut sink, run);
            let result = result.map_err(|error| of_offset(error, output))?;
            Ok((result, sink.seconds))
        }
    }
}

/// Makes the offset slab by slab within so many bytes, and streams its mesh to the output.
fn in_slabs(
    mesh: &TriMesh,
    arguments: &OffsetArguments,
    settings: &OffsetSettings,
    memory: u64,
    output: &Path,
    session: &Session,
) -> Result<(OffsetResult, f64), Failure> {
    let staged = session.staging.stage(output)?;
    let named = |error| of_output(error, output);
    let stream = MeshStream::create(&staged, coordinates(arguments.more.f64)).map_err(named)?;
    let mut sink = Streamed { stream, seconds: 0.0 };
    let result = offset_in_slabs(mesh, settings, Cut::Memory(memory), &mut sink, &session.run)
        .map_err(|error| of_offset(error, output))?;
    let started = Instant::now();
    sink.stream.finish().map_err(named)?;
    Ok((result, sink.seconds + started.elapsed().as_secs_f64()))
}

fn way(arguments: &OffsetArguments, output: &Path, session: &Session) -> Result<Way, Failure> {
    let in_pieces = matches!(format(output)?, Format::Ply | Format::Stl);
    let limit = session.max_memory;
    Ok(match (arguments.tile, arguments.stream) {
        (Some(tile), _) => Way::Tile(tile),
        (None, true) => Way::Slabs(limit.unwrap_or(STREAM_MEMORY)),
        (None, false) => {
            Way::Whole { or_slabs: in_pieces.then(|| limit.or_else(available_memory)).flatten() }
        }
    })
}

/// Checks that a mesh that is to be made in pieces can be.
pub(super) fn check_pieces(arguments: &OffsetArguments) -> Result<(), Failure> {
    let option = match arguments {
        OffsetArguments { tile: Some(_), .. } => "--tile",
        OffsetArguments { stream: true, .. } => "--stream",
        _ => return Ok(()),
    };
    let Some(output) = &arguments.output else {
        return Err(Failure::usage(format!("{option} makes a mesh; name it with -o")));
    };
    match format(output)? {
        Format::Ply | Format::Stl => Ok(()),
        other => {
            let shown = output.display();
            Err(Failure::usage(format!(
                "{shown}: {option} writes PLY and STL, not {other}; write .ply or .stl"
            )))
        }
    }
}

/// What a tile's files say of it: its number, and what identifies the input and what is made of it.
pub(super) fn identity(tile: TileNumber, mesh: &TriMesh, settings: &OffsetSettings) -> Tile {
    Tile { number: tile.number, of: tile.of, job: job(mesh, settings) }
}

/// The user knows nothing of the temporary path.
fn of_output(error: SaveError, output: &Path) -> Failure {
    SaveError { path: output.into(), ..error }.into()
}

/// Names the output in an error of the file that the mesh goes to.
fn of_offset(error: OffsetError, output: &Path) -> Failure {
    match error {
        OffsetError::Sink(error) => match error.downcast::<SaveError>() {
            Ok(error) => of_output(*error, output),
            Err(error) => OffsetError::Sink(error).into(),
        },
        other => other.into(),
    }
}

/// Pieces go to a file as they come.
struct Streamed {
    stream: MeshStream,
    seconds: f64,
}

impl PieceSink for Streamed {
    fn restart(&mut self) -> Result<(), SinkError> {
        Ok(self.stream.clear()?)
    }

    fn piece(&mut self, piece: &SlabContour) -> Result<(), SinkError> {
        let started = Instant::now();
        self.stream.append(&piece.mesh, piece.vertices.clone(), piece.triangles.clone())?;
        self.seconds += started.elapsed().as_secs_f64();
        Ok(())
    }
}

/// The only piece of a tile.
struct Tiled {
    staged: PathBuf,
    tile: Tile,
    f64: bool,
    seconds: f64,
}

impl PieceSink for Tiled {
    fn restart(&mut self) -> Result<(), SinkError> {
        // A tile that the surface does not pass is a file without triangles.
        Ok(save_tile(&self.staged, &TriMesh::default(), 0..0, 0..0, self.tile, coordinates(self.f64))?)
    }

    fn piece(&mut self, piece: &SlabContour) -> Result<(), SinkError> {
        let started = Instant::now();
        let (vertices, triangles) = (piece.vertices.clone(), piece.triangles.clone());
        save_tile(&self.staged, &piece.mesh, vertices, triangles, self.tile, coordinates(self.f64))?;
        self.seconds += started.elapsed().as_secs_f64();
        Ok(())
    }
}
