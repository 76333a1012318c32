//! Time of the hierarchy, the band and a whole offset on a generated model.

use criterion::{Criterion, criterion_group, criterion_main};
use exocarp::distance::SignedDistance;
use exocarp::mesh::{Topology, shapes};
use exocarp::offset::{Length, OffsetSettings, VoxelSize, offset};
use exocarp::run::{Cancelled, RunSettings};
use exocarp::{band, ssvh};
use std::hint::black_box;

/// Nodes along the longest side: enough for every stage to take milliseconds.
const RESOLUTION: u32 = 128;

fn stages(c: &mut Criterion) {
    let mesh = shapes::anchor(shapes::DEFAULT_DETAIL);
    let topology = Topology::new(&mesh);
    let run = RunSettings::with_threads(0).expect("threads");
    let settings = OffsetSettings {
        distance: Length::OfDiagonal(0.02),
        voxel: VoxelSize::Resolution(RESOLUTION),
        ..OffsetSettings::default()
    };
    let resolved = settings.resolve(&mesh).expect("settings of a bench");
    let distance = run.install(|| SignedDistance::new(&mesh, &topology));

    let mut group = c.benchmark_group("anchor");
    group.sample_size(20);
    group.bench_function("hierarchy", |b| b.iter(|| run.install(|| black_box(ssvh::Ssvh::new(&mesh)))));
    group.bench_function("band", |b| {
        b.iter(|| {
            band::build(&distance, &resolved, &run, |batch| {
                black_box(batch);
                Ok::<_, Cancelled>(())
            })
        })
    });
    group.bench_function("offset", |b| {
        b.iter(|| black_box(offset(&mesh, &settings, &run).expect("an offset of the bench's model")))
    });
    group.finish();
}

criterion_group!(benches, stages);
criterion_main!(benches);
