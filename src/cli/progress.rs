//! The progress bar.

use exocarp::{Phase, Progress};
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Mutex;
use std::time::Duration;

/// One bar over all phases, with the phase's name and an estimate of the time left.
pub(super) struct Bar {
    bar: ProgressBar,
    now: Mutex<Now>,
}

struct Now {
    phase: Phase,
    total: u64,
}

/// The length of the bar in parts.
const PARTS: u64 = 1000;

/// The share of a phase in the whole, in parts. Wrong shares make the estimate jump, no more; these
/// are typical of resolution 256.
fn share(phase: Phase) -> u64 {
    match phase {
        Phase::Load => 50,
        Phase::Clean => 30,
        Phase::Hierarchy => 50,
        Phase::Band => 400,
        Phase::Edges => 220,
        Phase::Contour => 200,
        Phase::Write => 50,
    }
}

/// The parts before a phase.
fn before(phase: Phase) -> u64 {
    Phase::ALL.into_iter().take_while(|p| *p != phase).map(share).sum()
}

impl Bar {
    pub fn new() -> Self {
        let style = ProgressStyle::with_template("{msg:<9} [{bar:32}] {percent:>3}%  {elapsed}, {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .progress_chars("=> ");
        let bar = ProgressBar::new(PARTS).with_style(style);
        // Keeps the elapsed time going within long steps.
        bar.enable_steady_tick(Duration::from_millis(200));
        Bar { bar, now: Mutex::new(Now { phase: Phase::Load, total: 0 }) }
    }

    /// Takes the bar away, writes, and puts it back.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Progress for Bar {
    fn begin(&self, phase: Phase, total: u64) {
        self.bar.set_message(phase.name());
        self.bar.set_position(before(phase));
        if let Ok(mut now) = self.now.lock() {
            *now = Now { phase, total };
        }
    }

    fn advance(&self, phase: Phase, done: u64) {
        // A worker that finds the lock taken leaves the report to the next one.
        let Ok(now) = self.now.try_lock() else { return };
        if now.phase == phase && now.total > 0 {
            self.bar.set_position(before(phase) + share(phase) * done.min(now.total) / now.total);
        }
    }

    fn end(&self, phase: Phase) {
        self.bar.set_position(before(phase) + share(phase));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_fill_the_bar() {
        assert_eq!(Phase::ALL.into_iter().map(share).sum::<u64>(), PARTS);
        assert_eq!(before(Phase::Load), 0);
        assert_eq!(before(Phase::Write), PARTS - share(Phase::Write));
    }
}
