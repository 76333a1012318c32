//! The time that choosing and making the triangles takes, by method (\[LW11\] Table VI).

use super::edge_polygon::{EdgePolygon, for_polygons};
use super::envelope::Envelope;
use super::triangulate::{Cut, Fit, Polygon, polygonize};
use crate::band::SignField;
use crate::contour::error::ContourError;
use crate::contour::feature::CreasePlanes;
use crate::contour::settings::{ContourSettings, CutMethod};
use crate::contour::vertex::{PlacedVertices, with_vertices};
use crate::edge::Crossings;
use crate::lattice::Lattice;
use crate::run::RunSettings;
use std::time::Instant;

/// The polygons of a few leaves are cut this often by each method, and the shortest time counts: an
/// interrupt or a cold cache hits one round, not all three.
const ROUNDS: usize = 3;

/// What one method did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CutTimes {
    /// Seconds on one thread for the polygons around all crossed edges.
    pub seconds: f64,
    /// Their triangles.
    pub triangles: u64,
    /// Polygons that needed a vertex on their grid edge.
    pub split: u64,
}

/// Cuts the polygons of the surface once by each of `methods`, on one thread, and measures that part alone.
///
/// # Errors
/// As [`contour`](crate::contour::contour).
///
/// # Panics
/// When `crossings` does not belong to `signs`.
pub fn cut_times<const N: usize>(
    signs: &SignField,
    crossings: &Crossings,
    lattice: Lattice,
    settings: &ContourSettings,
    methods: [CutMethod; N],
    run: &RunSettings,
) -> Result<[CutTimes; N], ContourError> {
    with_vertices(signs, crossings, lattice, None, settings, run, |placed, phase| {
        let PlacedVertices { cells, faces, vertices, .. } = placed;
        let mut times = [CutTimes::default(); N];
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
            for (times, method) in times.iter_mut().zip(methods) {
                let mut shortest = f64::INFINITY;
                for _ in 0..ROUNDS {
                    triangles.clear();
                    let started = Instant::now();
                    let split = cut_all(&polygons, method, &mut triangles);
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

fn cut_all(
    polygons: &[(Polygon, Envelope, Fit<'_>)],
    method: CutMethod,
    triangles: &mut Vec<[u32; 3]>,
) -> u64 {
    let mut split = 0;
    for (polygon, envelope, fit) in polygons {
        split += u64::from(polygonize(polygon, envelope, fit, method, triangles) == Cut::Split);
    }
    split
}
