//! Writes the narrow band of an offset as a level set for any OpenVDB program: `cargo run --release
//! --example write_band`.

use exocarp::vdb::{FileInfo, VdbOptions};
use exocarp::{Length, OffsetSettings, RunSettings, VoxelSize, offset_band, shapes};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = shapes::carved_cube(16);
    let settings = OffsetSettings {
        distance: Length::Units(0.05),
        voxel: VoxelSize::Units(0.02),
        ..OffsetSettings::default()
    };
    // The band alone: `offset` makes the mesh as well.
    let result = offset_band(&model, &settings, &RunSettings::with_threads(0)?)?;

    std::fs::create_dir_all("out")?;
    let path = Path::new("out/example-band.vdb");
    let options = VdbOptions {
        distance: Some(result.statistics.distance),
        unit: Some("mm".into()),
        ..VdbOptions::default()
    };
    result.band.save(path, &options)?;

    for grid in FileInfo::read(path)?.grids {
        println!("{}: {} {}, {} active voxels", path.display(), grid.class, grid.name, grid.active_voxels);
    }
    Ok(())
}
