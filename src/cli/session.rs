//! State that all commands share: verbosity, threads, the interrupt, the time.

use super::args::Common;
use super::exit::{Exit, Failure, log_interrupted, log_line, of_io};
use super::outputs::Staging;
use super::progress::Bar;
use exocarp::{CancelToken, Phase, RunSettings};
use std::io::{IsTerminal, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Verbosity of the messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Verbosity {
    /// Errors only.
    Quiet,
    /// A line per result, warnings, and a progress bar on a terminal.
    Normal,
    /// Phases and counts as well.
    Verbose,
}

/// A running command.
pub(super) struct Session {
    pub started: Instant,
    pub verbosity: Verbosity,
    pub run: RunSettings,
    /// The memory that may be used, in bytes; `None` for what the system has available.
    pub max_memory: Option<u64>,
    /// The files being written.
    pub staging: Staging,
    bar: Option<Arc<Bar>>,
}

impl Session {
    /// Starts the threads and installs the interrupt handler.
    pub fn start(common: &Common, started: Instant) -> Result<Self, Failure> {
        let verbosity = match (common.quiet, common.verbose) {
            (true, _) => Verbosity::Quiet,
            (false, false) => Verbosity::Normal,
            (false, true) => Verbosity::Verbose,
        };
        let cancel = CancelToken::default();
        let staging = Staging::new(cancel.clone());
        handle_interrupt(cancel.clone(), staging.clone());
        let mut run = RunSettings::with_threads(common.threads.map_or(0, |n| n.get()))?.with_cancel(cancel);
        let visible = verbosity > Verbosity::Quiet && std::io::stderr().is_terminal();
        let bar = visible.then(|| Arc::new(Bar::new()));
        if let Some(bar) = &bar {
            run = run.with_progress(bar.clone());
        }
        Ok(Session { started, verbosity, run, max_memory: common.max_memory, staging, bar })
    }

    /// Runs one phase and measures it, in seconds.
    pub fn phase<T>(
        &self,
        phase: Phase,
        work: impl FnOnce() -> Result<T, Failure>,
    ) -> Result<(T, f64), Failure> {
        let start = Instant::now();
        let guard = self.run.phase(phase, 0);
        let value = work()?;
        drop(guard);
        self.run.check()?;
        Ok((value, start.elapsed().as_secs_f64()))
    }

    /// A warning on stderr.
    pub fn warn(&self, sentence: &str) {
        if self.verbosity > Verbosity::Quiet {
            self.above_bar(|| log_line("warning", sentence));
        }
    }

    /// A result on stdout. Fails when it does not get there, as [`print`] does.
    pub fn print_result(&self, text: &str) -> Result<(), Failure> {
        if self.verbosity == Verbosity::Quiet {
            return Ok(());
        }
        self.above_bar(|| print(text))
    }

    /// Seconds since the command line was parsed.
    pub fn wall(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    fn above_bar<T>(&self, write: impl FnOnce() -> T) -> T {
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }
}

impl Drop for Session {
    /// A command that failed leaves nothing; one that succeeded has put its files in place by now.
    fn drop(&mut self) {
        self.staging.discard();
    }
}

/// Text on stdout, with a line end. A reader that went away (`| head`) is no error, a text that is
/// lost is one.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout();
    printed(writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()))
}

/// Turns an error of printing into a failure.
pub(super) fn printed(result: std::io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::new(
            of_io(&error),
            format!("the text for standard output is lost ({error}); check the free space where it goes"),
        )),
        _ => Ok(()),
    }
}

/// On Ctrl-C or the signal to terminate: cancels, gives the command a moment to end by itself, and
/// ends the program if it does not.
fn handle_interrupt(cancel: CancelToken, staging: Staging) {
    // Reading and writing a file or building a hierarchy cannot be cancelled. The promise is to
    // stop within 200 ms, and removing a large incomplete file takes some of them.
    const GRACE: Duration = Duration::from_millis(20);
    let handler = move || {
        cancel.cancel();
        std::thread::sleep(GRACE);
        // Waits for outputs that are just being put in place, and removes incomplete ones.
        staging.discard();
        if std::io::stderr().is_terminal() {
            // The bar may still be there: to the line's beginning, and clear it.
            let _ = write!(std::io::stderr(), "\r\x1b[2K");
        }
        log_interrupted();
        std::process::exit(i32::from(Exit::Interrupted as u8));
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        log_line("warning", &format!("Ctrl-C will leave temporary files behind: {error}"));
    }
}
