//! The ways to make an offset: as a whole, slab by slab, one tile of it, or its band only.

use super::args::OffsetArguments;
use super::exit::Failure;
use super::files::{format, precision, save_mesh};
use super::session::Session;
use exocarp::internals::system::available_memory;
use exocarp::io::{Format, MeshStream, SaveError, Tile, save_tile};
use exocarp::vdb::Band;
use exocarp::{
    BandResult, MeshChunk, MeshSink, OffsetError, OffsetResult, OffsetSettings, OffsetStatistics, Partition,
    StreamResult, TileIndex, TriMesh, offset, offset_band, offset_streamed,
};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Memory of a streamed run where no limit is given: 1 GiB.
const STREAM_MEMORY: u64 = 1 << 30;

/// A way to make the mesh of an offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Strategy {
    /// All at once, or slab by slab within so many bytes where that does not fit.
    Whole { or_slabs: Option<u64> },
    /// Slab by slab, within so many bytes.
    Slabs(u64),
    /// One tile.
    Tile(TileIndex),
}

/// An offset whose mesh, if there is one, is staged.
pub(super) struct Made {
    pub band: Option<Band>,
    pub statistics: OffsetStatistics,
    /// Seconds that writing the mesh took.
    pub seconds: f64,
}

/// Makes the offset and stages its mesh.
pub(super) fn execute(
    mesh: &TriMesh,
    arguments: &OffsetArguments,
    settings: &OffsetSettings,
    session: &Session,
) -> Result<Made, Failure> {
    let run = &session.run;
    let Some(output) = &arguments.output else {
        let BandResult { band, statistics } = offset_band(mesh, settings, run)?;
        return Ok(Made { band: Some(band), statistics, seconds: 0.0 });
    };
    match strategy(arguments, output, session)? {
        Strategy::Whole { or_slabs } => {
            let result = match (offset(mesh, settings, run), or_slabs) {
                (Err(OffsetError::Memory(_)), Some(memory)) => {
                    return in_slabs(mesh, arguments, settings, memory, output, session);
                }
                (result, _) => result?,
            };
            let OffsetResult { mesh, precision, band, statistics } = result;
            let started = Instant::now();
            save_mesh(&mesh, output, precision, session)?;
            Ok(Made { band, statistics, seconds: started.elapsed().as_secs_f64() })
        }
        Strategy::Slabs(memory) => in_slabs(mesh, arguments, settings, memory, output, session),
        Strategy::Tile(index) => {
            let path = session.staging.stage(output)?;
            let tile = Tile::new(index, mesh, settings);
            let mut sink = TileFile { path, tile, f64: arguments.more.f64, seconds: 0.0 };
            let result = offset_streamed(mesh, settings, Partition::Tile(index), &mut sink, run);
            let StreamResult { band, statistics } = result.map_err(|error| of_offset(error, output))?;
            Ok(Made { band, statistics, seconds: sink.seconds })
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
) -> Result<Made, Failure> {
    let staged = session.staging.stage(output)?;
    let named = |error| of_output(error, output);
    let stream = MeshStream::create(&staged, precision(arguments.more.f64)).map_err(named)?;
    let mut sink = TimedStream { stream, seconds: 0.0 };
    let result = offset_streamed(mesh, settings, Partition::Memory(memory), &mut sink, &session.run);
    let StreamResult { band, statistics } = result.map_err(|error| of_offset(error, output))?;
    let started = Instant::now();
    sink.stream.finish().map_err(named)?;
    Ok(Made { band, statistics, seconds: sink.seconds + started.elapsed().as_secs_f64() })
}

fn strategy(arguments: &OffsetArguments, output: &Path, session: &Session) -> Result<Strategy, Failure> {
    let in_pieces = matches!(format(output)?, Format::Ply | Format::Stl);
    let limit = session.max_memory;
    Ok(match (arguments.tile, arguments.stream) {
        (Some(tile), _) => Strategy::Tile(tile),
        (None, true) => Strategy::Slabs(limit.unwrap_or(STREAM_MEMORY)),
        (None, false) => {
            Strategy::Whole { or_slabs: in_pieces.then(|| limit.or_else(available_memory)).flatten() }
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

/// Names the output instead of the temporary path, of which the user knows nothing.
fn of_output(error: SaveError, output: &Path) -> Failure {
    SaveError { path: output.into(), ..error }.into()
}

/// A mesh file that takes chunks as they come, with the seconds that this took.
struct TimedStream {
    stream: MeshStream,
    seconds: f64,
}

impl MeshSink for TimedStream {
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.stream.restart()
    }

    fn chunk(&mut self, chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
        let started = Instant::now();
        self.stream.chunk(chunk)?;
        self.seconds += started.elapsed().as_secs_f64();
        Ok(())
    }
}

/// The file of a tile, with the seconds that writing took.
struct TileFile {
    path: PathBuf,
    tile: Tile,
    f64: bool,
    seconds: f64,
}

impl MeshSink for TileFile {
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        // A tile that the surface does not pass is a file without triangles.
        self.chunk(&MeshChunk::empty())
    }

    fn chunk(&mut self, chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
        let started = Instant::now();
        save_tile(&self.path, chunk, self.tile, precision(self.f64))?;
        self.seconds += started.elapsed().as_secs_f64();
        Ok(())
    }
}
