//! `exocarp merge`: tiles joined to the whole.

use super::args::MergeArguments;
use super::exit::Failure;
use super::files::{check_input, is_vdb};
use super::format::{counted, grouped};
use super::outputs;
use super::session::Session;
use exocarp::io::merge_tiles;
use exocarp::vdb::{VdbError, merge_bands};
use exocarp::{Error, Phase};
use std::path::Path;

pub(super) fn run(arguments: &MergeArguments, session: &Session) -> Result<(), Failure> {
    let MergeArguments { tiles, output, .. } = arguments;
    tiles.iter().try_for_each(|tile| check_input(tile))?;
    outputs::check([output.as_path()])?;
    let staged = session.staging.stage(output)?;
    let (what, _) = session.phase(Phase::Write, || {
        let merge = || -> Result<String, Error> {
            if is_vdb(output) {
                let voxels = merge_bands(tiles, &staged)?.surface.active_voxels();
                return Ok(format!("{} active voxels", grouped(voxels)));
            }
            let (vertices, triangles) = merge_tiles(tiles, &staged)?;
            let triangles = format!("{} triangles", grouped(triangles));
            // STL has none.
            Ok(if vertices > 0 { format!("{triangles}, {} vertices", grouped(vertices)) } else { triangles })
        };
        merge().map_err(|error| of_output(error, &staged, output).into())
    })?;
    session.staging.commit()?;
    session.print_result(&format!(
        "{}: {what} of {}, {:.2} s",
        output.display(),
        counted(tiles.len(), "tile", "tiles"),
        session.wall(),
    ))
}

/// The user knows nothing of the temporary path.
fn of_output(error: Error, staged: &Path, output: &Path) -> Error {
    match error {
        Error::Merge(mut error) if error.path == staged => {
            error.path = output.into();
            error.into()
        }
        Error::Vdb(VdbError::Write { reason, source, .. }) => {
            VdbError::Write { path: output.into(), reason, source }.into()
        }
        other => other,
    }
}
