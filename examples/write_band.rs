//! Writes the narrow band of an offset as a level set for any OpenVDB program: `cargo run --release --example
//! write_band`.

use exocarp::mesh::shapes;
use exocarp::offset::{Length, OffsetSettings, VoxelSize, offset};
use exocarp::run::RunSettings;
use exocarp::vdb::{self, VdbOptions};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = shapes::anchor(shapes::DEFAULT_DETAIL);
    let settings = OffsetSettings {
        distance: Length::Units(0.05),
        voxel: VoxelSize::Units(0.02),
        // Contouring needs 1 voxel on each side; other programs expect 3.
        half_width: 3.0,
        ..OffsetSettings::default()
    };
    let result = offset(&model, &settings, &RunSettings::with_threads(0)?)?;

    std::fs::create_dir_all("out")?;
    let path = Path::new("out/example-band.vdb");
    let options = VdbOptions {
        distance: Some(result.statistics.distance),
        unit: Some("mm".into()),
        ..VdbOptions::default()
    };
    vdb::write(path, &result.band.surface, result.band.closest.as_ref(), &options)?;

    for grid in vdb::info(path)?.grids {
        println!("{}: {} {}, {} active voxels", path.display(), grid.class, grid.name, grid.active_voxels);
    }
    Ok(())
}
