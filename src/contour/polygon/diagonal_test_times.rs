//! The time of choosing and making the triangles, by diagonal test (\[LW11\] Table VI).

use super::edge_polygon::{EdgePolygon, for_polygons};
use super::envelope::Envelope;
use super::triangulate::{Fit, Polygon, Split, triangulate_polygon};
use crate::band::SignField;
use crate::contour::error::ContourError;
use crate::contour::feature::CreasePlanes;
use crate::contour::settings::{ContourSettings, DiagonalTest};
use crate::contour::vertex::{PlacedVertices, with_vertices};
use crate::edge::Crossings;
use crate::lattice::Lattice;
use crate::run::RunSettings;
use std::time::Instant;

/// The number of times that the polygons of a leaf are split by each test. The shortest time
/// counts: an interrupt or a cold cache hits one round, not all three.
const ROUNDS: usize = 3;

/// The time and the results of one test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiagonalTestTimes {
    /// Seconds on one thread for the polygons around all crossed edges.
    pub seconds: f64,
    /// The number of triangles.
    pub triangles: u64,
    /// The number of polygons that needed a vertex on their grid edge.
    pub split: u64,
}

/// Splits the polygons of the surface by each of `tests`, on one thread, and measures that part
/// alone.
///
/// # Errors
/// As [`contour`](crate::contour::contour).
///
/// # Panics
/// When `crossings` does not belong to `signs`.
pub fn time_diagonal_tests<const N: usize>(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    settings: &ContourSettings,
    tests: [DiagonalTest; N],
    run: &RunSettings,
) -> Result<[DiagonalTestTimes; N], ContourError> {
    with_vertices(signs, crossings, lattice, None, settings, run, |placed, phase| {
        let PlacedVertices { cells, faces, vertices, .. } = placed;
        let mut times = [DiagonalTestTimes::default(); N];
        let mut polygons: Vec<(Polygon, Envelope, Fit<'static>)> = Vec::new();
        let mut triangles = Vec::new();
        for leaf in crossings.numbers.leaves() {
            phase.advance(1)?;
            polygons.clear();
            for_polygons(
                &cells,
                &faces,
                &vertices,
                leaf,
                |EdgePolygon { polygon, envelope, fit, .. }| {
                    // Without a surface to ask there are no features, and no crease planes.
                    polygons.push((*polygon, envelope, Fit { crease_planes: &CreasePlanes::NONE, ..fit }));
                },
            );
            for (times, test) in times.iter_mut().zip(tests) {
                let mut shortest = f64::INFINITY;
                for _ in 0..ROUNDS {
                    triangles.clear();
                    let started = Instant::now();
                    let split = split_all(&polygons, test, &mut triangles);
                    let seconds = started.elapsed().as_secs_f64();
                    if shortest.is_infinite() {
                        times.split += split;
                        times.triangles += triangles.len() as u64;
                    }
                    shortest = shortest.min(seconds);
                }
                times.seconds += shortest;
            }
        }
        Ok(times)
    })
}

fn split_all(
    polygons: &[(Polygon, Envelope, Fit<'_>)],
    test: DiagonalTest,
    triangles: &mut Vec<[u32; 3]>,
) -> u64 {
    let mut split = 0;
    for (polygon, envelope, fit) in polygons {
        split +=
            u64::from(triangulate_polygon(polygon, envelope, fit, test, u32::MAX, triangles) == Split::Fan);
    }
    split
}
