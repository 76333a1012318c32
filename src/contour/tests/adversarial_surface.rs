//! The promise does not depend on the samples of the surface: adversarial ones, on random lattices.

use crate::contour::tests::fields::{Random, run_with};
use crate::contour::tests::random::{PLACES, is_heavy, lattice};
use crate::contour::{ContourStatistics, Creases, ImplicitSurface, SurfaceSample};
use crate::lattice::Ijk;
use crate::verify::tests::audit::audit;
use glam::DVec3;

/// A surface whose samples have nothing to do with anything, but are the same for the same point.
struct AdversarialSurface {
    seed: u64,
    voxel: f64,
    creases: Creases,
}

impl ImplicitSurface for AdversarialSurface {
    fn creases(&self) -> Creases {
        self.creases
    }

    fn curvature(&self) -> f64 {
        0.1 / self.voxel
    }

    fn sample_triangle(&self, p: DVec3, triangle: u32) -> SurfaceSample {
        AdversarialSurface { seed: self.seed ^ u64::from(triangle % 7), ..*self }.sample(p, triangle)
    }

    fn sample(&self, p: DVec3, _: u32) -> SurfaceSample {
        // Coarse steps half of the time, so that neighbouring samples agree and features are found.
        let step = if self.seed.is_multiple_of(2) { self.voxel } else { 1e-9 * self.voxel };
        let key = p.to_array().into_iter().fold(self.seed, |k, x| {
            k.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ ((x / step).floor() as i64 as u64)
        });
        let mut random = Random(key);
        let triangle = random.bits() as u32;
        let distance = match random.unit() {
            u if u < 0.01 => f64::NAN,
            u if u < 0.02 => f64::INFINITY,
            u if u < 0.03 => -1e300,
            u if u < 0.4 => 0.0,
            _ => (4.0 * random.unit() - 2.0) * self.voxel,
        };
        let gradient = if random.unit() < 0.02 { [f64::NAN, 0.0, 1.0] } else { random.direction() };
        SurfaceSample { distance, gradient: gradient.into(), triangle }
    }
}

fn check(seed: u64, n: i32) -> ContourStatistics {
    let (voxel, at, precision) = PLACES[(seed % PLACES.len() as u64) as usize];
    let corner = Ijk::new(at, 3 - at / 2, at / 3 + 5);
    let creases = [Creases::Concave, Creases::Convex, Creases::Both][(seed % 3) as usize];
    let surface = AdversarialSurface { seed, voxel, creases };
    let tolerance = seed.is_multiple_of(4).then_some(1.9);
    let field = lattice(seed, n, corner);
    let (mesh, statistics) = run_with(&field, voxel, (precision, tolerance), 2, &surface);
    let audit = audit(&mesh);
    assert!(audit.is_sound(), "seed {seed}, {n}^3: {audit:?}, {statistics:?}");
    assert!(mesh.vertices.iter().flatten().all(|&x| precision.round(x) == x));
    let mut positions = mesh.vertices.clone();
    positions.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap());
    assert!(positions.windows(2).all(|pair| pair[0] != pair[1]), "two vertices at one position, seed {seed}");
    // The same bytes for another number of threads.
    let other = run_with(&field, voxel, (precision, tolerance), 1, &surface).0;
    assert!(other.vertices == mesh.vertices && other.triangles == mesh.triangles, "seed {seed}");
    statistics
}

fn check_all(seeds: std::ops::Range<u64>, n: i32) {
    let mut sum = ContourStatistics::default();
    for seed in seeds {
        sum += check(seed, n);
    }
    println!("{n}^3: {sum:?}");
    assert!([sum.recovered, sum.refused, sum.flipped, sum.refined].iter().all(|&n| n > 10), "{sum:?}");
}

#[test]
fn adversarial_surfaces_break_nothing() {
    check_all(0..if is_heavy() { 500 } else { 24 }, 6);
}

#[test]
fn nor_on_larger_lattices() {
    check_all(1_000_000..if is_heavy() { 1_000_020 } else { 1_000_001 }, 12);
}
