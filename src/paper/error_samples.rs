//! The distance error of an offset surface, by samples. It goes by unsigned distances: where the sign of an input
//! that is no solid jumps, a sample on the wrong side would count with twice the offset.

use crate::distance::SignedDistance;
use crate::mesh::TriMesh;
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use rayon::prelude::*;

/// Deviations of an offset surface from its distance, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// The mean of | |dis(p)| - |r| | over all samples.
    pub mean: f64,
    /// The largest of them.
    pub max: f64,
    /// The number of samples.
    pub samples: u64,
}

/// Triangles per task: some milliseconds of work.
const CHUNK: usize = 4096;

/// Samples | |dis(p)| - |r| | at the vertices, the edge midpoints and the centroids of a closed `mesh`, each once.
///
/// # Errors
/// Cancellation.
pub fn errors(
    distance: &SignedDistance,
    mesh: &TriMesh,
    r: f64,
    run: &RunSettings,
) -> Result<Errors, Cancelled> {
    let at = |v: u32| DVec3::from(mesh.vertices[v as usize]);
    let vertices = mesh.vertices.par_chunks(CHUNK).map(|vertices| {
        run.check()?;
        Ok(Part::of(distance, r, vertices.iter().map(|&v| v.into())))
    });
    let triangles = mesh.triangles.par_chunks(CHUNK).map(|triangles| {
        run.check()?;
        let points = triangles.iter().flat_map(|&[a, b, c]| {
            // Each edge has two triangles, which run along it in opposite directions: one of them counts.
            let edges = [[a, b], [b, c], [c, a]].into_iter().filter(|[v, w]| v < w);
            let midpoints = edges.map(move |[v, w]| 0.5 * (at(v) + at(w)));
            midpoints.chain([(at(a) + at(b) + at(c)) / 3.0])
        });
        Ok(Part::of(distance, r, points))
    });
    // Parts are added in their order, so that the mean has the same bits for every number of threads.
    let parts: Vec<Part> = run.install(|| vertices.chain(triangles).collect::<Result<_, Cancelled>>())?;
    let mut all = Part::default();
    for part in parts {
        all.sum += part.sum;
        all.max = all.max.max(part.max);
        all.samples += part.samples;
    }
    Ok(Errors { mean: all.sum / all.samples.max(1) as f64, max: all.max, samples: all.samples })
}

#[derive(Clone, Copy, Default)]
struct Part {
    sum: f64,
    max: f64,
    samples: u64,
}

impl Part {
    fn of(distance: &SignedDistance, r: f64, points: impl Iterator<Item = DVec3>) -> Part {
        let mut part = Part::default();
        let mut guess = 0;
        for p in points {
            let sample = distance.at(p, guess);
            guess = sample.triangle;
            let error = (sample.distance.abs() - r.abs()).abs();
            part.sum += error;
            part.max = part.max.max(error);
            part.samples += 1;
        }
        part
    }
}
