//! Watches an offset and stops it after a while: `cargo run --release --example
//! progress_and_cancel`.

use exocarp::{
    CancelToken, OffsetError, OffsetSettings, Phase, Progress, RunSettings, VoxelSize, offset, shapes,
};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Prints the beginning and the end of each phase. Worker threads call it, so it keeps no state.
struct Printer;

impl Progress for Printer {
    fn begin(&self, phase: Phase, total: u64) {
        println!("{} begins ({total} steps)", phase.name());
    }

    fn advance(&self, _phase: Phase, _done: u64) {}

    fn end(&self, phase: Phase) {
        println!("{} ends", phase.name());
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = shapes::carved_cube(48);
    let cancel = CancelToken::default();
    let run = RunSettings::with_threads(0)?.with_cancel(cancel.clone()).with_progress(Arc::new(Printer));

    // A button, a signal handler, or here: another thread with a clock.
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(300));
        cancel.cancel();
    });

    let started = Instant::now();
    let settings = OffsetSettings { voxel: VoxelSize::Resolution(1000), ..OffsetSettings::default() };
    match offset(&model, &settings, &run) {
        Ok(result) => println!("done before the clock: {} triangles", result.mesh.triangles.len()),
        Err(OffsetError::Cancelled) => println!("cancelled after {:.2} s", started.elapsed().as_secs_f64()),
        Err(other) => return Err(other.into()),
    }
    Ok(())
}
