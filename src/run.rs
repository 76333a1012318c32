//! Running of a computation, as opposed to what it computes: threads, cancellation, progress.
//!
//! [`RunSettings`] is passed last to everything that takes time. Nothing in it changes a result:
//! the same input gives the same bytes for every number of threads.

mod bytes;

pub use bytes::Bytes;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The stages that a user sees in the progress bar and in the statistics file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Phase {
    /// Reading and parsing the input file.
    Load,
    /// Welding, dropping degenerate triangles, building the topology.
    Clean,
    /// Building the swept-sphere volume hierarchy.
    Hierarchy,
    /// Filters and narrow band.
    Band,
    /// Intersections of grid edges with the offset surface.
    Edges,
    /// Dual contouring.
    Contour,
    /// Writing the output files.
    Write,
}

impl Phase {
    /// All phases, in the order in which they run.
    pub const ALL: [Phase; 7] = [
        Phase::Load,
        Phase::Clean,
        Phase::Hierarchy,
        Phase::Band,
        Phase::Edges,
        Phase::Contour,
        Phase::Write,
    ];

    /// The name used in the statistics file.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Load => "load",
            Phase::Clean => "clean",
            Phase::Hierarchy => "hierarchy",
            Phase::Band => "band",
            Phase::Edges => "edges",
            Phase::Contour => "contour",
            Phase::Write => "write",
        }
    }
}

/// Receives progress. Called from worker threads, so implementations must be cheap and thread-safe.
pub trait Progress: Send + Sync {
    /// A phase begins that consists of `total` steps (0: not known beforehand).
    fn begin(&self, phase: Phase, total: u64);
    /// `done` of the phase's steps are finished.
    fn advance(&self, phase: Phase, done: u64);
    /// The phase is complete.
    fn end(&self, phase: Phase);
}

/// The computation was cancelled through its [`CancelToken`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// A flag that stops a running computation from another thread or a signal handler.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks the computation to stop. It returns [`Cancelled`] within a few milliseconds.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Returns `Err(Cancelled)` once cancelled, for use with `?`.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// Leaves, or things like vertices, that a thread takes on at a time at most. Left alone, rayon
/// cuts a loop into a few parts for each thread, and all wait for the last part: with two threads
/// for up to a tenth of the loop.
pub const SHARE: usize = 64;

/// Thread pool, cancel token and progress receiver of a run.
///
/// Nothing in it changes a result: the same input gives the same bytes for every number of threads.
/// The default runs in rayon's current pool, which is that of the calling program.
#[derive(Clone, Default)]
pub struct RunSettings {
    /// `None` for the current pool of rayon.
    pool: Option<Arc<rayon::ThreadPool>>,
    cancel: CancelToken,
    progress: Option<Arc<dyn Progress>>,
}

/// The thread pool could not be started.
#[derive(Debug, thiserror::Error)]
#[error("could not start {threads} worker threads: {source}")]
pub struct ThreadError {
    threads: usize,
    source: rayon::ThreadPoolBuildError,
}

impl RunSettings {
    /// Returns a run with `threads` worker threads of its own; 0 means one per available core.
    ///
    /// # Errors
    /// When the operating system refuses the threads.
    pub fn with_threads(threads: usize) -> Result<Self, ThreadError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("exocarp-{i}"))
            .build()
            .map_err(|source| ThreadError { threads, source })?;
        Ok(RunSettings::in_pool(Arc::new(pool)))
    }

    /// Returns a run with a single worker thread.
    ///
    /// # Errors
    /// When the operating system refuses the thread.
    pub fn serial() -> Result<Self, ThreadError> {
        RunSettings::with_threads(1)
    }

    /// Returns a run in a thread pool that may serve other work, too.
    pub fn in_pool(pool: Arc<rayon::ThreadPool>) -> Self {
        RunSettings { pool: Some(pool), ..RunSettings::default() }
    }

    /// Returns the same run, stopped by `cancel`.
    pub fn with_cancel(mut self, cancel: CancelToken) -> Self {
        self.cancel = cancel;
        self
    }

    /// Returns the same run, reporting to `progress`.
    pub fn with_progress(mut self, progress: Arc<dyn Progress>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Returns the number of worker threads.
    pub fn threads(&self) -> usize {
        self.pool.as_ref().map_or_else(rayon::current_num_threads, |pool| pool.current_num_threads())
    }

    /// Returns the token that stops this run.
    pub fn cancel_token(&self) -> &CancelToken {
        &self.cancel
    }

    /// Returns `Err(Cancelled)` once the run's token was cancelled.
    pub fn check(&self) -> Result<(), Cancelled> {
        self.cancel.check()
    }

    /// Runs `f` inside the thread pool, so that rayon's parallel iterators in it use this run's
    /// threads.
    pub fn install<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(f),
            // Whatever is parallel in it goes to rayon's current pool by itself.
            None => f(),
        }
    }

    /// Begins a phase of `total` steps; it ends when the returned guard is dropped.
    pub fn phase(&self, phase: Phase, total: u64) -> PhaseGuard<'_> {
        if let Some(progress) = &self.progress {
            progress.begin(phase, total);
        }
        PhaseGuard { run: self, phase, done: AtomicU64::new(0) }
    }
}

impl std::fmt::Debug for RunSettings {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunSettings")
            .field("threads", &self.threads())
            .field("cancelled", &self.cancel.is_cancelled())
            .field("progress", &self.progress.is_some())
            .finish()
    }
}

/// A running phase. Workers report finished steps to it.
pub struct PhaseGuard<'a> {
    run: &'a RunSettings,
    phase: Phase,
    done: AtomicU64,
}

impl PhaseGuard<'_> {
    /// Reports that `steps` more steps are finished. Returns `Err(Cancelled)` when the run shall
    /// stop, so that every report of progress is also a point of cancellation.
    pub fn advance(&self, steps: u64) -> Result<(), Cancelled> {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        if let Some(progress) = &self.run.progress {
            progress.advance(self.phase, done);
        }
        self.run.check()
    }
}

impl Drop for PhaseGuard<'_> {
    fn drop(&mut self) {
        if let Some(progress) = &self.run.progress {
            progress.end(self.phase);
        }
    }
}
