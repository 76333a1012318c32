//! Random lattices made to be nasty, each judged by the exact audit.

use crate::band::SignField;
use crate::contour::polygon::time_diagonal_tests;
use crate::contour::tests::fields::{Random, crossings, run, run_by, signs};
use crate::contour::{ContourSettings, ContourStatistics, DiagonalTest, Precision};
use crate::edge::{Crossing, Crossings};
use crate::lattice::{Axis, Ijk};
use crate::verify::tests::audit::audit;

/// Whether the long run was asked for.
pub(super) fn is_heavy() -> bool {
    std::env::var_os("EXOCARP_HEAVY").is_some_and(|v| v == "1")
}

/// Crossings anywhere, often right next to a corner, and normals that point anywhere, so that most
/// minimisers lie far outside their cells.
fn nasty(random: &mut Random, signs: &SignField) -> Crossings {
    let ends = random.unit();
    crossings(signs, |_, _| {
        let t = match random.unit() {
            u if u < 0.3 * ends => 0.0,
            u if u < 0.6 * ends => 1.0,
            u if u < 0.8 * ends => 1e-6 * random.unit(),
            _ => random.unit(),
        };
        Crossing { t, normal: random.direction().map(|x| x as f32), triangle: 0 }
    })
}

/// A lattice of random signs in n^3 nodes from `corner` on.
pub(super) fn lattice(seed: u64, n: i32, corner: Ijk) -> (SignField, Crossings) {
    let mut random = Random(seed);
    let density = 0.2 + 0.6 * random.unit();
    let nodes: Vec<bool> = (0..n * n * n).map(|_| random.unit() < density).collect();
    let field = signs(corner, corner + Ijk([n - 1; 3]), |node| {
        let [x, y, z] = (node - corner).0;
        nodes[((x * n + y) * n + z) as usize]
    });
    let crossings = nasty(&mut random, &field);
    (field, crossings)
}

/// Lattices: voxel size, lowest node, precision. The second has a few hundred, the third some ten
/// 32-bit coordinates per voxel, the fourth node planes that are off by a thousandth of a voxel.
pub(super) const PLACES: [(f64, i32, Precision); 5] = [
    (1.0, 0, Precision::F32),
    (0.1, 200_000, Precision::F32),
    (0.1, -640_000, Precision::F32),
    (1.0 / 3.0, 12_345, Precision::F32),
    (0.1, 1_000_003, Precision::F64),
];

fn check(seed: u64, n: i32) -> (ContourStatistics, usize) {
    let (voxel, at, precision) = PLACES[(seed % PLACES.len() as u64) as usize];
    let corner = Ijk::new(at, 3 - at / 2, at / 3 + 5);
    let (mesh, statistics) = run(&lattice(seed, n, corner), voxel, precision, 1);
    let audit = audit(&mesh);
    assert!(audit.is_sound(), "seed {seed}, {n}^3: {audit:?}, {statistics:?}");
    assert!(mesh.vertices.iter().flatten().all(|&x| precision.round(x) == x));
    (statistics, audit.intersections.tested as usize)
}

fn check_all(seeds: std::ops::Range<u64>, n: i32) {
    let (mut sum, mut pairs) = (ContourStatistics::default(), 0);
    let count = seeds.end - seeds.start;
    for seed in seeds {
        let (statistics, tested) = check(seed, n);
        sum += statistics;
        pairs += tested;
    }
    println!("{count} lattices of {n}^3: {pairs} pairs, {sum:?}");
    // Nothing of the construction went untried.
    let tried = [sum.several_sheets, sum.face_vertices, sum.clamped, sum.split, sum.diagonal];
    assert!(tried.iter().all(|&n| n > count), "{sum:?}");
}

#[test]
fn random_lattices_are_closed_manifold_and_free_of_intersections() {
    check_all(0..if is_heavy() { 10_000 } else { 300 }, 6);
}

#[test]
fn the_test_of_ju_and_udeshi_keeps_the_promise_with_no_fewer_triangles() {
    for seed in 0..60 {
        let field = lattice(seed, 6, Ijk([-2; 3]));
        let [analysis, polygon_edges] = [DiagonalTest::ConvexConcave, DiagonalTest::PolygonEdges]
            .map(|test| run_by(test, &field, 0.1, Precision::F32));
        let audit = audit(&polygon_edges.0);
        assert!(audit.is_sound(), "seed {seed}: {audit:?}, {:?}", polygon_edges.1);
        assert!(polygon_edges.1.triangles >= analysis.1.triangles, "seed {seed}");
        assert_eq!(polygon_edges.1.quads, analysis.1.quads);
        // The table's own measurement cuts the same polygons.
        let tests = [DiagonalTest::ConvexConcave, DiagonalTest::PolygonEdges];
        let run = crate::run::RunSettings::with_threads(1).unwrap();
        let settings = ContourSettings { precision: Precision::F32, ..ContourSettings::default() };
        let lattice = crate::lattice::Lattice { voxel: 0.1 };
        let times = time_diagonal_tests(&field.0, &field.1, lattice, &settings, tests, &run).unwrap();
        for (times, (mesh, statistics)) in times.iter().zip([&analysis, &polygon_edges]) {
            assert_eq!((times.triangles, times.split), (mesh.triangles.len() as u64, statistics.split));
            assert!(times.seconds > 0.0);
        }
    }
}

#[test]
fn larger_random_lattices_too() {
    check_all(1_000_000..if is_heavy() { 1_000_050 } else { 1_000_002 }, 24);
}

/// Every mask of a cell in the middle, in random surroundings.
#[test]
fn all_masks_in_random_surroundings() {
    let rounds = if is_heavy() { 20 } else { 1 };
    for round in 0..rounds {
        for mask in 0..256u64 {
            let mut random = Random(1000 * round + mask);
            let n = 4;
            let nodes: Vec<bool> = (0..64).map(|_| random.unit() < 0.5).collect();
            let field = signs(Ijk([6; 3]), Ijk([9; 3]), |node| {
                let [x, y, z] = (node - Ijk([6; 3])).0;
                let middle = [x, y, z].iter().all(|c| (1..3).contains(c));
                let corner = (x - 1) + 2 * (y - 1) + 4 * (z - 1);
                if middle { mask >> corner & 1 == 1 } else { nodes[((x * n + y) * n + z) as usize] }
            });
            let crossings = nasty(&mut random, &field);
            let (mesh, _) = run(&(field, crossings), 0.7, Precision::F32, 1);
            let audit = audit(&mesh);
            assert!(audit.is_sound(), "mask {mask:#x}, round {round}: {audit:?}");
        }
    }
}

/// What is not a number must not break anything.
#[test]
fn broken_crossings_still_give_a_closed_mesh() {
    let (field, _) = lattice(7, 6, Ijk([-3; 3]));
    let mut n = 0;
    let crossings = crossings(&field, |_, axis| {
        n += 1;
        let bad = [f64::NAN, f64::INFINITY, -5.0, 0.5][n % 4];
        let normal = match axis {
            Axis::X => [f32::NAN, 0.0, 0.0],
            Axis::Y => [0.0; 3],
            Axis::Z => [f32::MAX, f32::INFINITY, 1.0],
        };
        Crossing { t: bad, normal, triangle: 0 }
    });
    let (mesh, _) = run(&(field, crossings), 1.0, Precision::F32, 2);
    assert!(audit(&mesh).is_sound());
}
