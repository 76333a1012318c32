//! Cancelling: whatever is running, and whichever phase it is in, the error is `Cancelled`.

use exocarp::verify::{VerifyError, VerifySettings, verify};
use exocarp::{
    BandOptions, CancelToken, Length, MeshChunk, MeshSink, OffsetError, OffsetSettings, Partition, Phase,
    Progress, RunSettings, ThickenError, ThickenSettings, TileIndex, TriMesh, VoxelSize, offset, offset_band,
    offset_streamed, shapes, thicken,
};
use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Cancels when phase number `at`, counted from 0, begins, and counts the phases.
struct CancelAt {
    at: usize,
    begun: AtomicUsize,
    cancel: CancelToken,
}

impl Progress for CancelAt {
    fn begin(&self, _phase: Phase, _total: u64) {
        if self.begun.fetch_add(1, Ordering::SeqCst) == self.at {
            self.cancel.cancel();
        }
    }

    fn advance(&self, _phase: Phase, _done: u64) {}

    fn end(&self, _phase: Phase) {}
}

/// Runs `operation` once to count its phases, and then once for each phase, cancelled when that
/// begins. Returns the number of phases.
fn cancel_in_each_phase<T, E: std::fmt::Debug>(
    operation: impl Fn(&RunSettings) -> Result<T, E>,
    is_cancelled: impl Fn(&E) -> bool,
) -> usize {
    let with = |at| {
        let cancel = CancelToken::default();
        let progress = Arc::new(CancelAt { at, begun: AtomicUsize::new(0), cancel: cancel.clone() });
        let run = RunSettings::with_threads(2).unwrap().with_cancel(cancel);
        (operation(&run.with_progress(progress.clone())), progress.begun.load(Ordering::SeqCst))
    };
    let (result, phases) = with(usize::MAX);
    assert!(result.is_ok(), "{:?}", result.err());
    for at in 0..phases {
        match with(at).0 {
            Err(error) => assert!(is_cancelled(&error), "phase {at} of {phases}: {error:?}"),
            Ok(_) => panic!("phase {at} of {phases} went on"),
        }
    }
    // A run that is cancelled before it starts.
    let cancel = CancelToken::default();
    cancel.cancel();
    let run = RunSettings::with_threads(2).unwrap().with_cancel(cancel);
    match operation(&run) {
        Err(error) => assert!(is_cancelled(&error), "at first: {error:?}"),
        Ok(_) => panic!("what was cancelled at first went on"),
    }
    phases
}

fn settings() -> OffsetSettings {
    OffsetSettings {
        distance: Length::Units(0.1),
        voxel: VoxelSize::Resolution(40),
        band: Some(BandOptions::default()),
        ..OffsetSettings::default()
    }
}

fn is_cancelled(error: &OffsetError) -> bool {
    matches!(error, OffsetError::Cancelled)
}

/// A receiver that drops what it gets.
struct Nowhere;

impl MeshSink for Nowhere {
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }

    fn chunk(&mut self, _chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }
}

#[test]
fn an_offset_is_cancelled_in_each_phase() {
    let mesh = shapes::carved_cube(6);
    for settings in [settings(), OffsetSettings { band: None, ..settings() }] {
        let phases = cancel_in_each_phase(|run| offset(&mesh, &settings, run), is_cancelled);
        assert!(phases >= 4, "{phases}");
    }
}

#[test]
fn a_band_is_cancelled_in_each_phase() {
    let mesh = shapes::carved_cube(6);
    let phases = cancel_in_each_phase(|run| offset_band(&mesh, &settings(), run), is_cancelled);
    assert!(phases >= 2, "{phases}");
}

#[test]
fn slabs_and_tiles_are_cancelled_in_each_phase() {
    let mesh = shapes::carved_cube(6);
    for partition in [Partition::Memory(1 << 30), Partition::Tile(TileIndex::new(1, 2).unwrap())] {
        let stream = |run: &RunSettings| offset_streamed(&mesh, &settings(), partition, &mut Nowhere, run);
        let phases = cancel_in_each_phase(stream, is_cancelled);
        assert!(phases >= 4, "{phases}");
    }
}

#[test]
fn a_receiver_that_is_cancelled_cancels_the_run() {
    /// A receiver whose own work was cancelled.
    struct Cancelled;
    impl MeshSink for Cancelled {
        fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
            Ok(())
        }
        fn chunk(&mut self, _chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
            Err(exocarp::Cancelled.into())
        }
    }
    let (mesh, run) = (shapes::carved_cube(6), RunSettings::default());
    let result = offset_streamed(&mesh, &settings(), Partition::Memory(1 << 30), &mut Cancelled, &run);
    assert!(matches!(result, Err(OffsetError::Cancelled)), "{result:?}");
}

#[test]
fn thickening_is_cancelled_in_each_phase() {
    let is_cancelled = |error: &ThickenError| matches!(error, ThickenError::Cancelled);
    let thickness = Length::DiagonalFraction(0.1);
    let settings = ThickenSettings { thickness, ..ThickenSettings::default() };
    // An open patch, and a closed one, which gets an offset for a cavity.
    for patch in [shapes::wave(4), shapes::sphere(4)] {
        let phases = cancel_in_each_phase(|run| thicken(&patch, &settings, run), is_cancelled);
        assert!(phases >= 1, "{phases}");
    }
}

#[test]
fn a_judgement_is_cancelled() {
    let is_cancelled = |error: &VerifyError| matches!(error, VerifyError::Cancelled);
    let model = shapes::sphere(6);
    let output: TriMesh =
        offset(&model, &OffsetSettings { band: None, ..settings() }, &RunSettings::default()).unwrap().mesh;
    let settings =
        VerifySettings { distance: Length::Units(0.1), samples: 2000, ..VerifySettings::default() };
    cancel_in_each_phase(|run| verify(&model, &output, &settings, run), is_cancelled);
}
