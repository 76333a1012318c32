//! Offsets a generated model outward and inward and saves the results: `cargo run --release
//! --example offset_model`.

use exocarp::{Length, OffsetSettings, RunSettings, VoxelSize, offset, shapes};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = shapes::carved_cube(16);
    let run = RunSettings::with_threads(0)?;
    std::fs::create_dir_all("out")?;
    println!("model: volume {:.4}", model.signed_volume());
    for (name, distance) in [("grown", 0.1), ("shrunk", -0.1)] {
        let settings = OffsetSettings {
            distance: Length::Units(distance),
            voxel: VoxelSize::Resolution(128),
            ..OffsetSettings::default()
        };
        let result = offset(&model, &settings, &run)?;
        let path = format!("out/example-{name}.ply");
        result.save(&path)?;
        println!(
            "{path}: {} triangles, volume {:.4}, {:.2} s",
            result.mesh.triangles.len(),
            result.mesh.signed_volume(),
            result.statistics.times.total(),
        );
    }
    Ok(())
}
