//! `exocarp paper`: the tables of the method's paper, measured here.

use super::args::PaperArguments;
use super::exit::{Exit, Failure};
use super::files::save_json;
use super::outputs;
use super::session::Session;
use exocarp::internals::paper::{PaperSettings, Report, Table, measure};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

pub(super) fn run(arguments: &PaperArguments, session: &Session) -> Result<(), Failure> {
    outputs::check(arguments.json.iter().map(PathBuf::as_path))?;
    let settings = PaperSettings {
        resolution: arguments.resolution,
        files: arguments.models.as_deref().map_or(Ok(Vec::new()), files)?,
        max_memory: session.max_memory,
    };
    let one = arguments.table.and_then(Table::from_number);
    let tables = one.map_or(Table::ALL.to_vec(), |table| vec![table]);
    let mut reports = Vec::with_capacity(tables.len());
    for table in tables {
        let report = measure(table, &settings, &session.run)?;
        session.print_result(&(report.text() + "\n"))?;
        reports.push(report);
    }
    if let Some(path) = &arguments.json {
        save(path, arguments, &reports, session)?;
        session.staging.commit()?;
    }
    Ok(())
}

/// The files of the models' directory, sorted by name.
fn files(directory: &Path) -> Result<Vec<PathBuf>, Failure> {
    let read = || -> std::io::Result<Vec<PathBuf>> {
        let entries = std::fs::read_dir(directory)?;
        let mut files =
            entries.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>()?;
        files.sort();
        Ok(files)
    };
    read().map_err(|error| {
        let shown = directory.display();
        Failure::new(Exit::Input, format!("{shown} cannot be read ({error}); --models names a directory"))
    })
}

fn save(
    output: &Path,
    arguments: &PaperArguments,
    reports: &[Report],
    session: &Session,
) -> Result<(), Failure> {
    let file = json!({
        "exocarp": env!("CARGO_PKG_VERSION"),
        "command": "paper",
        "settings": { "resolution": arguments.resolution, "threads": session.run.threads() },
        "tables": reports.iter().map(Report::json).collect::<Vec<Value>>(),
    });
    save_json(output, &file, session)
}
