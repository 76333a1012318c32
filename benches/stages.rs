//! Time of each stage, of the bridge to OpenVDB, and of a whole offset, on a generated model.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use exocarp::internals::band::{self, LeafBatch};
use exocarp::internals::band_settings;
use exocarp::internals::distance::SignedDistance;
use exocarp::internals::mesh::Topology;
use exocarp::internals::offset::EngineTimes;
use exocarp::internals::ssvh;
use exocarp::vdb::{ClosestGrid, SurfaceGrid};
use exocarp::{
    BandOptions, Cancelled, Length, OffsetSettings, RunSettings, TriMesh, VoxelSize, offset, offset_band,
    shapes,
};
use std::hint::black_box;
use std::time::Duration;

/// Nodes along the longest side: enough for every stage to take milliseconds.
const RESOLUTION: u32 = 128;

fn stages(c: &mut Criterion) {
    let mesh = shapes::anchor(shapes::DEFAULT_DETAIL);
    let run = RunSettings::with_threads(0).expect("threads");
    let settings = OffsetSettings {
        distance: Length::DiagonalFraction(0.02),
        voxel: VoxelSize::Resolution(RESOLUTION),
        ..OffsetSettings::default()
    };
    let mut group = c.benchmark_group("anchor");
    group.sample_size(20);
    group.bench_function("hierarchy", |b| b.iter(|| run.install(|| black_box(ssvh::Ssvh::new(&mesh)))));
    in_the_whole(&mut group, "band", &mesh, &settings, &run, |times| times.band);
    in_the_whole(&mut group, "edges", &mesh, &settings, &run, |times| times.edges);
    in_the_whole(&mut group, "contour", &mesh, &settings, &run, |times| times.contour);
    bridge(&mut group, &mesh, &settings, &run);
    group.bench_function("whole", |b| {
        b.iter(|| black_box(offset(&mesh, &settings, &run).expect("an offset of the bench's model")))
    });
    let stored = OffsetSettings { band: Some(BandOptions::default()), ..settings.clone() };
    group.bench_function("stored band alone", |b| {
        b.iter(|| black_box(offset_band(&mesh, &stored, &run).expect("a band of the bench's model")))
    });
    group.finish();
}

/// A stage as it runs in the whole: it needs what the stages before it made.
fn in_the_whole(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    mesh: &TriMesh,
    settings: &OffsetSettings,
    run: &RunSettings,
    seconds: impl Fn(&EngineTimes) -> f64,
) {
    group.bench_function(name, |b| {
        b.iter_custom(|times| {
            let one = || seconds(&offset(mesh, settings, run).expect("an offset").statistics.times);
            Duration::from_secs_f64((0..times).map(|_| one()).sum())
        });
    });
}

/// Handing the leaves of a band to OpenVDB.
fn bridge(
    group: &mut BenchmarkGroup<'_, WallTime>,
    mesh: &TriMesh,
    settings: &OffsetSettings,
    run: &RunSettings,
) {
    let topology = Topology::new(mesh);
    let stored = OffsetSettings { band: Some(BandOptions::default()), ..settings.clone() };
    let resolved = band_settings(&stored, mesh).expect("settings");
    let distance = run.install(|| SignedDistance::new(mesh, &topology));
    let mut batches: Vec<LeafBatch> = Vec::new();
    band::build(&distance, &resolved, run, |batch| {
        batches.push(batch);
        Ok::<_, Cancelled>(())
    })
    .expect("not cancelled");
    group.bench_function("bridge", |b| {
        b.iter(|| {
            let mut surface = SurfaceGrid::new(resolved.lattice, resolved.half_width).expect("a grid");
            let mut closest = ClosestGrid::new(resolved.lattice).expect("a grid");
            for batch in &batches {
                surface.insert_leaves(&batch.origins, &batch.values, &batch.active).expect("leaves");
                closest.insert_leaves(&batch.origins, &batch.closest, &batch.active).expect("leaves");
            }
            black_box((surface.leaf_count(), closest.leaf_count()))
        });
    });
}

criterion_group!(benches, stages);
criterion_main!(benches);
