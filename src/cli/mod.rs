//! The command line: arguments in, files and one line out.
//!
//! Every command ends in an [`Exit`]: the table of exit codes is there and nowhere else. Errors are
//! one sentence on stderr, results one line on stdout.

mod args;
mod compare;
mod examples;
mod exit;
mod files;
mod info;
mod strategy;
mod merge;
mod model;
mod format;
mod offset;
mod outputs;
mod paper;
mod progress;
mod memory;
mod session;
mod statistics;
mod thicken;
mod thickness_map;
mod verify;

use args::{Arguments, Command};
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use exit::{Exit, Failure};
use session::Session;
use std::process::ExitCode;
use std::time::Instant;

/// Parses the arguments, runs the command, and turns what comes of it into an exit code.
pub fn main() -> ExitCode {
    memory::return_large_blocks();
    memory::let_large_writes_fail();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return usage(&error),
    };
    let started = Instant::now();
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|l| format!(" at {l}")).unwrap_or_default();
        let text = panic.payload().downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.payload().downcast_ref::<&str>().copied()).unwrap_or("no message");
        exit::log_line(
            "error",
            &format!("internal error{place}: {text}; this is a bug in exocarp, please report it"),
        );
    }));
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| run(arguments, started)));
    match outcome {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => failure.report(),
        // The hook has said why.
        Err(_) => Exit::Internal.into(),
    }
}

fn run(arguments: Arguments, started: Instant) -> Result<(), Failure> {
    match arguments.command {
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "exocarp", &mut script);
            session::print(&String::from_utf8_lossy(&script))
        }
        Command::Offset(command) => offset::run(&command, &Session::start(&arguments.common, started)?),
        Command::Merge(command) => merge::run(&command, &Session::start(&arguments.common, started)?),
        Command::Thicken(command) => thicken::run(&command, &Session::start(&arguments.common, started)?),
        Command::Compare(command) => compare::run(&command, &Session::start(&arguments.common, started)?),
        Command::Worker(command) => {
            compare::run_worker(&command, &Session::start(&arguments.common, started)?)
        }
        Command::Model(command) => model::run(&command, &Session::start(&arguments.common, started)?),
        Command::Verify(command) => verify::run(&command, &Session::start(&arguments.common, started)?),
        Command::Paper(command) => paper::run(&command, &Session::start(&arguments.common, started)?),
        Command::Info(command) => info::run(&command, &Session::start(&arguments.common, started)?),
    }
}

/// Help and version go to stdout; anything else that clap has to say is wrong use, in one sentence.
fn usage(error: &clap::Error) -> ExitCode {
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match session::printed(error.print()) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => failure.report(),
        },
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
            let _ = error.print();
            Exit::Usage.into()
        }
        _ => {
            let text = error.render().to_string();
            let text = text.split("\n\nUsage:").next().unwrap_or_default();
            let text = text.split("\n\nFor more information").next().unwrap_or_default();
            let sentence = text.split_whitespace().collect::<Vec<_>>().join(" ");
            let sentence = sentence.trim_start_matches("error: ").replace(" tip: ", "; ");
            Failure::usage(format!("{sentence}; see exocarp --help")).report()
        }
    }
}
