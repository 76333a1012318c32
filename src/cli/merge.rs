//! `exocarp merge`: tiles joined to the whole.

use super::args::MergeArguments;
use super::exit::{Exit, Failure, of_io};
use super::numbers::grouped;
use super::outputs;
use super::session::Session;
use exocarp::io::{MergeProblem, merge_tiles};
use exocarp::run::Phase;

pub(super) fn run(arguments: &MergeArguments, session: &Session) -> Result<(), Failure> {
    let output = &arguments.output;
    outputs::check([output.as_path()])?;
    let staged = session.staging.stage(output)?;
    let ((vertices, triangles), _) = session.phase(Phase::Write, || {
        merge_tiles(&arguments.tiles, &staged).map_err(|mut error| {
            if error.path == staged {
                // The user knows nothing of the temporary path.
                error.path.clone_from(output);
            }
            let exit = match &error.problem {
                MergeProblem::Write(e) => of_io(e),
                MergeProblem::TooLarge => Exit::Limit,
                _ => Exit::Input,
            };
            Failure::new(exit, error.to_string())
        })
    })?;
    session.staging.commit()?;
    session.tell(&format!(
        "{}: {} triangles, {} vertices of {} tiles, {:.2} s",
        output.display(),
        grouped(triangles),
        grouped(vertices),
        arguments.tiles.len(),
        session.wall(),
    ));
    Ok(())
}
