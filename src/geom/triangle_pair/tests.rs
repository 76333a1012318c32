//! Pairs of triangles against the oracle.
//!
//! On grids of a few nodes every degeneracy occurs: coplanar pairs, corners on sides, sides through
//! corners, needles, copies. With `EXOCARP_HEAVY=1` all pairs on a grid of 3 x 3 x 3 nodes, too.

use super::meeting_point;
use super::oracle::{Exact, common_part, exact_point, meet_elsewhere, normal, volume};
use crate::geom::predicates::{are_apart, orient3d, projection_axis};
use num_rational::{BigRational, Ratio};
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestRunner};
use rayon::prelude::*;
use std::cell::RefCell;
use std::collections::BTreeMap;

type Corners = [[f64; 3]; 3];

/// Returns a runner whose cases are the same each time, so that what they cover can be counted.
fn runner(cases: u32) -> TestRunner {
    let is_heavy = std::env::var_os("EXOCARP_HEAVY").is_some_and(|v| v == "1");
    let cases = if is_heavy { 50 * cases } else { cases };
    TestRunner::new(ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(11),
        failure_persistence: None,
        max_global_rejects: u32::MAX,
        ..ProptestConfig::default()
    })
}

fn exact<T: Exact>(t: Corners) -> [[T; 3]; 3] {
    t.map(exact_point)
}

fn has_area(t: Corners) -> bool {
    projection_axis(t).is_some()
}

/// The distance beyond which a point is outside of a triangle of about unit size: rounding errors
/// of its coordinates.
const ROUNDED: f64 = 1e-12;

/// Whether a point is in a triangle, up to rounding.
fn contains(t: Corners, p: [f64; 3]) -> bool {
    let [a, b, c] = t.map(glam::DVec3::from);
    let p = glam::DVec3::from(p);
    let normal = (b - a).cross(c - a).normalize();
    let in_plane = normal.dot(p - a).abs() <= ROUNDED;
    let mut sides = [(a, b), (b, c), (c, a)].into_iter();
    in_plane && sides.all(|(from, to)| normal.cross((to - from).normalize()).dot(p - from) >= -ROUNDED)
}

/// Asserts that code and oracle say the same of a pair, and of the pair the other way round.
/// Returns whether the triangles meet.
fn check<T: Exact>(va: [u32; 3], pa: Corners, vb: [u32; 3], pb: Corners) -> bool {
    let expected = meet_elsewhere(va, &exact::<T>(pa), vb, &exact::<T>(pb));
    let found = meeting_point(va, pa, vb, pb);
    assert_eq!(found.is_some(), expected, "{va:?} {pa:?} {vb:?} {pb:?}");
    assert_eq!(meeting_point(vb, pb, va, pa).is_some(), expected, "{vb:?} {pb:?} {va:?} {pa:?}");
    if let Some(at) = found {
        assert!(contains(pa, at) && contains(pb, at), "{at:?} in {pa:?} and {pb:?}");
    }
    expected
}

/// Six points and vertex numbers; the second triangle has some of the first one's.
#[derive(Clone, Debug)]
struct Pair {
    va: [u32; 3],
    pa: Corners,
    vb: [u32; 3],
    pb: Corners,
}

impl Pair {
    /// Replaces corners of the second triangle by `shared` corners of the first one, from corner
    /// `from` to corner `to` on.
    fn new(pa: Corners, mut pb: Corners, shared: usize, (from, to): (usize, usize)) -> Pair {
        let va = [0, 1, 2];
        let mut vb = [3, 4, 5];
        // Along one triangle or against it: neighbours in a mesh run against each other.
        for k in 0..shared {
            let (i, j) = ((from + k) % 3, (to + 3 - k) % 3);
            (vb[j], pb[j]) = (va[i], pa[i]);
        }
        Pair { va, pa, vb, pb }
    }
}

/// Pairs on a grid of integers, one in four of them in a plane.
fn pairs_on_a_grid() -> impl Strategy<Value = Pair> {
    let corners = || prop::array::uniform3(prop::array::uniform3(-2..=2i8));
    (corners(), corners(), 0..=3usize, (0..3usize, 0..3usize), 0..8u8, -2..=2i8).prop_map(
        |(mut a, mut b, shared, at, flat, height)| {
            if flat < 2 {
                // The plane z = height, or the slanted one x + z = height.
                for p in a.iter_mut().chain(&mut b) {
                    p[2] = if flat == 0 { height } else { height - p[0] };
                }
            }
            let corners = |t: [[i8; 3]; 3]| t.map(|p| p.map(f64::from));
            Pair::new(corners(a), corners(b), shared, at)
        },
    )
}

#[test]
fn random_pairs_on_a_grid() {
    let kinds = RefCell::new(BTreeMap::new());
    let check_pair = |pair: Pair| {
        let Pair { va, pa, vb, pb } = pair;
        for t in [pa, pb] {
            let is_flat = normal(&exact::<Ratio<i128>>(t)).iter().all(Zero::is_zero);
            assert_eq!(has_area(t), !is_flat, "{t:?}");
        }
        prop_assume!(has_area(pa) && has_area(pb));
        let meets = check::<Ratio<i128>>(va, pa, vb, pb);
        let shared = va.iter().filter(|v| vb.contains(v)).count();
        let coplanar = pb.iter().all(|&p| orient3d(pa[0], pa[1], pa[2], p) == 0.0);
        let part = common_part(&exact::<Ratio<i128>>(pa), &exact(pb)).len().min(3);
        *kinds.borrow_mut().entry((shared, coplanar, meets, part)).or_insert(0) += 1;
        Ok(())
    };
    runner(40_000).run(&pairs_on_a_grid(), check_pair).unwrap();
    let kinds = kinds.into_inner();
    let count = |shared, coplanar, meets| -> usize {
        let parts = (0..=3).filter_map(|part| kinds.get(&(shared, coplanar, meets, part)));
        parts.sum()
    };
    // Each answer occurs often with each number of shared vertices, in a plane and not.
    for shared in 0..3 {
        for coplanar in [false, true] {
            assert!(count(shared, coplanar, true) > 200 || (shared, coplanar) == (2, false), "{kinds:?}");
            assert!(count(shared, coplanar, false) > 200, "{kinds:?}");
        }
    }
    // On a common edge but not in a plane, nothing can meet.
    assert_eq!(count(2, false, true), 0);
    // Points, segments and polygons in common.
    assert!(
        (1..=3).all(|part| kinds.iter().filter(|(k, _)| k.3 == part).map(|(_, n)| n).sum::<usize>() > 1_000)
    );
}

/// Returns all triangles with area whose corners are nodes of a grid, one for each three nodes.
fn triangles_on_a_grid([x, y, z]: [usize; 3]) -> Vec<([usize; 3], Corners)> {
    let nodes: Vec<[f64; 3]> =
        (0..x * y * z).map(|n| [n / (y * z), n / z % y, n % z].map(|i| i as f64)).collect();
    let mut all = Vec::new();
    for i in 0..nodes.len() {
        for j in i + 1..nodes.len() {
            all.extend((j + 1..nodes.len()).map(|k| ([i, j, k], [nodes[i], nodes[j], nodes[k]])));
        }
    }
    all.retain(|(_, t)| has_area(*t));
    all
}

/// Checks all pairs of triangles on a grid: as a mesh numbers them, equal nodes being one vertex,
/// and as triangles that share no vertex. Returns the number of pairs, and of those that meet.
fn check_all_pairs(grid: [usize; 3]) -> [usize; 2] {
    let triangles = triangles_on_a_grid(grid);
    let check_with_all = |(n, &(nodes, a)): (usize, &([usize; 3], Corners))| {
        let mut counts = [0; 2];
        for (m, &(others, b)) in triangles.iter().enumerate().skip(n) {
            // Another first corner and another direction each time.
            let turned = |t: [usize; 3]| {
                let k = (n + m) % 6;
                let t = [t[k % 3], t[(k + 1) % 3], t[(k + 2) % 3]];
                if k < 3 { t } else { [t[0], t[2], t[1]] }
            };
            let order = turned([0, 1, 2]);
            let b = order.map(|k| b[k]);
            let va = nodes.map(|v| v as u32);
            let welded = turned(others).map(|v| v as u32);
            for vb in [welded, welded.map(|v| v + 1_000)] {
                let meets = check::<Ratio<i128>>(va, a, vb, b);
                counts = [counts[0] + 1, counts[1] + usize::from(meets)];
            }
        }
        counts
    };
    let all = triangles.par_iter().enumerate().map(|(n, t)| check_with_all((n, t)));
    all.reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]])
}

#[test]
fn all_pairs_on_small_grids() {
    for (grid, triangles) in [([2, 2, 2], 56), ([4, 3, 1], 200), ([3, 2, 2], 216)] {
        let [pairs, meeting] = check_all_pairs(grid);
        assert_eq!(pairs, triangles * (triangles + 1), "{grid:?}");
        assert!(pairs / 4 < meeting && meeting < pairs, "{grid:?}: {meeting} of {pairs}");
    }
}

mod long {
    #[test]
    #[ignore = "takes minutes (EXOCARP_HEAVY=1)"]
    fn all_pairs_on_a_grid_of_27_nodes() {
        let [pairs, meeting] = super::check_all_pairs([3, 3, 3]);
        assert_eq!(pairs, 2_876 * 2_877);
        assert!(pairs / 4 < meeting && meeting < pairs, "{meeting} of {pairs}");
    }
}

/// Moves a coordinate by some units in its last place.
fn nudged(x: f64, units: i8) -> f64 {
    (0..units.unsigned_abs()).fold(x, |x, _| if units > 0 { x.next_up() } else { x.next_down() })
}

/// Pairs whose corners are near to, but mostly not on, the planes and sides that they would be on.
/// No coordinate is near 0 (those of the grid are -4 to 4): products of units in its last place
/// would underflow, and predicates are exact only where they do not.
fn nearly_degenerate_pairs() -> impl Strategy<Value = Pair> {
    let nudges = || prop::array::uniform3(prop::array::uniform3(-1..=1i8));
    (pairs_on_a_grid(), nudges(), nudges(), 0.1..1.0f64).prop_map(|(pair, na, nb, scale)| {
        let moved = |p: Corners, n: [[i8; 3]; 3]| -> Corners {
            std::array::from_fn(|k| {
                std::array::from_fn(|axis| nudged(scale * (p[k][axis] + 5.0), n[k][axis]))
            })
        };
        let (pa, mut pb) = (moved(pair.pa, na), moved(pair.pb, nb));
        for (p, v) in pb.iter_mut().zip(pair.vb) {
            if let Some(k) = pair.va.iter().position(|&w| w == v) {
                *p = pa[k];
            }
        }
        Pair { pa, pb, ..pair }
    })
}

#[test]
fn the_last_bit_of_a_coordinate_decides() {
    let counts = RefCell::new([0; 2]);
    let check_pair = |Pair { va, pa, vb, pb }: Pair| {
        prop_assume!(has_area(pa) && has_area(pb));
        // The point is not looked at: nearly in a plane, rounding errors are as large as the
        // heights that it follows from.
        let expected = meet_elsewhere(va, &exact::<BigRational>(pa), vb, &exact(pb));
        for found in [meeting_point(va, pa, vb, pb), meeting_point(vb, pb, va, pa)] {
            assert_eq!(found.is_some(), expected, "{va:?} {pa:?} {vb:?} {pb:?}");
        }
        counts.borrow_mut()[usize::from(expected)] += 1;
        Ok(())
    };
    runner(3_000).run(&nearly_degenerate_pairs(), check_pair).unwrap();
    assert!(counts.borrow().iter().all(|&n| n > 300), "{counts:?}");
}

#[test]
fn predicates_have_the_signs_of_exact_determinants() {
    let check_points = |Pair { pa, pb, .. }: Pair| {
        let side = |p: [f64; 3]| volume(&exact::<BigRational>(pa), &exact_point(p));
        for p in pb {
            let expected = side(p);
            let found = orient3d(pa[0], pa[1], pa[2], p);
            assert_eq!((found > 0.0, found < 0.0), (expected.is_positive(), expected.is_negative()));
        }
        let expected = side(pb[0]).is_positive() && side(pb[1]).is_negative();
        assert_eq!(are_apart(pa, pb[0], pb[1]), expected, "{pa:?} {pb:?}");
        let is_flat = normal(&exact::<BigRational>(pa)).iter().all(Zero::is_zero);
        assert_eq!(has_area(pa), !is_flat, "{pa:?}");
        Ok(())
    };
    runner(4_000).run(&nearly_degenerate_pairs(), check_points).unwrap();
}

#[test]
fn numbers_become_exact() {
    let ratio = |numerator: i64, denominator: i64| BigRational::new(numerator.into(), denominator.into());
    assert_eq!(BigRational::exactly(-0.75), ratio(-3, 4));
    assert_eq!(BigRational::exactly(3.0), ratio(3, 1));
    assert_eq!(BigRational::exactly(2f64.powi(60)), ratio(1 << 60, 1));
    assert!(BigRational::exactly(f64::from_bits(1)).is_positive());
    assert_eq!(BigRational::exactly(1.0f64.next_up()) - ratio(1, 1), ratio(1, 1 << 52));
    assert_eq!(BigRational::exactly(-0.0), ratio(0, 1));
}
