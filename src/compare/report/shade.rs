//! Shaded pictures with the error as colour, as PNG.

use super::raster::{Camera, Frame, raster};
use crate::compare::CompareError;
use crate::distance::SignedDistance;
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use base64::Engine;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Whether the triangles' edges are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wires {
    /// Edges are drawn over the surface.
    Drawn,
    /// The surface only.
    Hidden,
}

/// The true offset, from which the colours measure the error.
#[derive(Clone, Copy)]
pub struct Truth<'a, 'm> {
    /// The model.
    pub distance: &'a SignedDistance<'m>,
    /// The offset distance.
    pub r: f64,
    /// The voxel size.
    pub voxel: f64,
}

/// Errors in voxels at the ends of the colour ramp, which is logarithmic: below the first nobody
/// sees anything, above the second everybody does.
pub const RAMP_ENDS: [f64; 2] = [0.001, 1.0];

/// The ramp: pale blue-grey, yellow, orange, red, black-purple. It gets darker all the way, so it
/// reads in grey and with any colour vision.
const RAMP: [[u8; 3]; 5] = [[236, 240, 244], [252, 214, 110], [240, 132, 50], [196, 42, 66], [52, 12, 74]];

/// Samples per pixel and direction: smooth outlines and wires.
const OVERSAMPLING: usize = 2;

/// The colour of an error in voxels.
pub fn ramp(error: f64) -> [u8; 3] {
    let [low, high] = RAMP_ENDS.map(f64::log10);
    let along = ((error.max(f64::MIN_POSITIVE).log10() - low) / (high - low)).clamp(0.0, 1.0);
    let place = along * (RAMP.len() - 1) as f64;
    let k = (place as usize).min(RAMP.len() - 2);
    let rest = place - k as f64;
    std::array::from_fn(|c| {
        let (a, b) = (f64::from(RAMP[k][c]), f64::from(RAMP[k + 1][c]));
        (a + (b - a) * rest).round() as u8
    })
}

/// A picture of `mesh`, `size` pixels wide, as PNG. The error is measured at the point that each
/// pixel shows.
///
/// # Errors
/// [`CompareError::Picture`]: never for pictures made here; the encoder wants it said.
pub fn shaded(
    mesh: &TriMesh,
    truth: &Truth,
    camera: &Camera,
    size: usize,
    wires: Wires,
    run: &RunSettings,
) -> Result<Vec<u8>, CompareError> {
    let frame = raster(mesh, camera, size * OVERSAMPLING);
    let rows: Vec<Vec<Vec3>> = run.install(|| {
        (0..frame.size).into_par_iter().map(|row| colours(&frame, row, mesh, truth, camera, wires)).collect()
    });
    let mut bytes = Vec::with_capacity(3 * size * size);
    for row in rows.chunks_exact(OVERSAMPLING) {
        for column in 0..size {
            let samples = row.iter().flat_map(|r| &r[column * OVERSAMPLING..(column + 1) * OVERSAMPLING]);
            let sum: Vec3 = samples.copied().sum();
            let mean = sum / (OVERSAMPLING * OVERSAMPLING) as f32;
            bytes.extend(mean.to_array().map(|c| c.round() as u8));
        }
    }
    png(&bytes, size)
}

fn colours(
    frame: &Frame,
    row: usize,
    mesh: &TriMesh,
    truth: &Truth,
    camera: &Camera,
    wires: Wires,
) -> Vec<Vec3> {
    // From the left above, over the viewer's shoulder.
    let plane = &camera.plane;
    let light = (plane.normal() * 1.0 + plane.up * 0.7 - plane.right * 0.5).normalize();
    let mut guess = 0;
    let pixel = |column: usize| {
        let Some(hit) = frame.pixels[row * frame.size + column] else { return Vec3::splat(255.0) };
        let sample = truth.distance.at(camera.point(column, row, frame.size, &hit), guess);
        guess = sample.triangle;
        let colour = ramp((sample.distance - truth.r).abs() / truth.voxel).map(f32::from);
        let [a, b, c] = mesh.corners(hit.triangle as usize).map(DVec3::from);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or(plane.normal());
        // Lambert, both sides alike, with as much from everywhere that colours stay legible in the
        // shade.
        let lambert = 0.7 + 0.3 * normal.dot(light).abs();
        let wire = match wires {
            Wires::Drawn if hit.edge < 0.5 * OVERSAMPLING as f64 => 0.7,
            _ => 1.0,
        };
        Vec3::from(colour) * (lambert * wire) as f32
    };
    (0..frame.size).map(pixel).collect()
}

/// RGB rows as a PNG file.
fn png(bytes: &[u8], size: usize) -> Result<Vec<u8>, CompareError> {
    let wrong = |e: png::EncodingError| CompareError::Picture(e.to_string());
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size as u32, size as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().map_err(wrong)?;
    writer.write_image_data(bytes).map_err(wrong)?;
    writer.finish().map_err(wrong)?;
    Ok(file)
}

/// A file as the address of an image.
pub fn data_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(png))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::report::plane::Plane;
    use crate::mesh::{Topology, shapes};

    #[test]
    fn the_ramp_darkens_all_the_way() {
        let luma = |e: f64| {
            let [r, g, b] = ramp(e).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let errors: Vec<f64> = (0..=60).map(|k| 10f64.powf(-3.0 + f64::from(k) / 20.0)).collect();
        assert!(errors.windows(2).all(|w| luma(w[0]) > luma(w[1])));
        assert_eq!((ramp(0.0), ramp(1e9)), (RAMP[0], RAMP[4]));
    }

    #[test]
    fn colours_are_those_of_the_error() {
        let mesh = shapes::cube(4);
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        let run = RunSettings::with_threads(1).unwrap();
        let camera = Camera { plane: Plane::new(DVec3::ZERO, DVec3::Y, DVec3::Z), half: 2.0 };
        // A face 0.1 voxels too far out.
        let truth = Truth { distance: &distance, r: -0.01, voxel: 0.1 };
        let file = shaded(&mesh, &truth, &camera, 32, Wires::Hidden, &run).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let at = |x: usize, y: usize| &bytes[3 * (32 * y + x)..][..3];
        assert_eq!(at(0, 0), [255, 255, 255]);
        let (seen, full) = (at(16, 16), ramp(0.1));
        let lights: Vec<f64> = (0..3).map(|c| f64::from(seen[c]) / f64::from(full[c])).collect();
        assert!(lights.iter().all(|l| (0.8..1.0).contains(l) && (l - lights[0]).abs() < 0.03), "{lights:?}");
    }
}
