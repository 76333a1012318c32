//! `exocarp compare`: the same offset with other programs; and the hidden command that does one run
//! of it.

use super::args::{CompareArguments, WorkerArguments};
use super::exit::{Exit, Failure};
use super::files::{load_mesh, save_json, save_text};
use super::offset::DEFAULT_RESOLUTION;
use super::outputs;
use super::session::{Session, Verbosity, print};
use exocarp::VoxelSize;
use exocarp::internals::compare::{
    CompareSettings, Comparison, Event, Job, Lost, Method, Programs, compare, report, text, work,
};
use std::path::PathBuf;
use std::time::Duration;

/// The page's name in the directory of the report.
const PAGE: &str = "index.html";

pub(super) fn run(arguments: &CompareArguments, session: &Session) -> Result<(), Failure> {
    let page = arguments.report.as_ref().map(|directory| directory.join(PAGE));
    if let Some(directory) = &arguments.report {
        std::fs::create_dir_all(directory).map_err(|error| {
            Failure::usage(format!("{} cannot be made a directory ({error})", directory.display()))
        })?;
    }
    outputs::check([&page, &arguments.json].into_iter().flatten().map(PathBuf::as_path))?;

    let (loaded, _) = load_mesh(&arguments.input, session)?;
    // What is lost of this is in the table, which is not lost unnoticed.
    let mut watch = |event: Event| drop(print_summary(&event, session));
    let comparison =
        compare(&loaded.mesh, &settings(arguments), &programs(arguments)?, &session.run, &mut watch)?;
    for note in &comparison.notes {
        session.warn(note);
    }
    if let Some(path) = &arguments.json {
        save_json(path, &comparison, session)?;
    }
    if let Some(path) = &page {
        if session.verbosity == Verbosity::Verbose {
            drop(session.print_result("drawing the report"));
        }
        let title = arguments.input.file_name().unwrap_or_default().to_string_lossy();
        save_text(path, &report::page(&comparison, &loaded.mesh, &title, &session.run)?, session)?;
    }
    session.staging.commit()?;
    session.print_result(&text(&comparison))?;
    if let Some(path) = &page {
        session.print_result(&format!("{}: the table, charts and pictures", path.display()))?;
    }
    check(&comparison)
}

fn settings(arguments: &CompareArguments) -> CompareSettings {
    let voxel = match arguments.voxel {
        Some(h) => VoxelSize::Units(h),
        None => VoxelSize::Resolution(arguments.resolution.unwrap_or(DEFAULT_RESOLUTION)),
    };
    let mut methods: Vec<Method> = Vec::new();
    for method in &arguments.methods {
        if !methods.contains(method) {
            methods.push(*method);
        }
    }
    CompareSettings {
        distance: arguments.distance,
        voxel,
        methods: if methods.is_empty() { Method::ALL.into() } else { methods },
        runs: arguments.runs,
        limit: Duration::from_secs(arguments.timeout),
        once_above: arguments.once_above.map_or(Duration::MAX, Duration::from_secs),
    }
}

fn programs(arguments: &CompareArguments) -> Result<Programs, Failure> {
    let worker = std::env::current_exe().map_err(|error| {
        Failure::new(Exit::Internal, format!("this program cannot find itself to start runs ({error})"))
    })?;
    Ok(Programs { worker, python: arguments.python.clone() })
}

fn print_summary(event: &Event, session: &Session) -> Result<(), Failure> {
    match event {
        Event::Lost(method, lost) => {
            session.warn(&format!("{}: {lost}", method.title()));
            Ok(())
        }
        _ if session.verbosity < Verbosity::Verbose => Ok(()),
        Event::Begin(run, method) => session.print_result(&format!("run {run}: {}", method.title())),
        Event::Measured(m) => session.print_result(&format!("  {:.2} s", m.engine)),
        Event::Judging(method) => session.print_result(&format!("judging {}", method.title())),
    }
}

/// Nothing to compare is a failure, one peer less is none.
fn check(comparison: &Comparison) -> Result<(), Failure> {
    if comparison.results.iter().any(|r| r.median.is_some()) {
        return Ok(());
    }
    let lost: Vec<(Method, &Lost)> =
        comparison.results.iter().filter_map(|r| Some((r.method, r.lost.as_ref()?))).collect();
    let is_broken = |lost: &Lost| match lost {
        Lost::Crashed(_) => true,
        Lost::Failed(reason) => reason.starts_with("internal error"),
        Lost::TimedOut(_) => false,
    };
    let exit = if lost.iter().any(|(_, lost)| is_broken(lost)) {
        Exit::Internal
    } else if lost.iter().any(|(_, lost)| matches!(lost, Lost::TimedOut(_))) {
        Exit::Limit
    } else {
        Exit::Empty
    };
    let first = lost.first().map(|(method, lost)| format!("; {}: {lost}", method.title()));
    Err(Failure::new(exit, format!("no method finished{}", first.unwrap_or_default())))
}

/// One run of one method, in this process.
pub(super) fn run_worker(arguments: &WorkerArguments, session: &Session) -> Result<(), Failure> {
    let job = Job {
        method: arguments.method,
        input: arguments.input.clone(),
        distance: arguments.distance,
        voxel: arguments.voxel,
        output: arguments.output.clone(),
    };
    let line = work(&job, &session.run)?.to_line();
    print(&line.map_err(|error| Failure::new(Exit::Internal, error.to_string()))?)
}
