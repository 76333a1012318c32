//! Sign fields and crossings from functions.

use crate::band::SignField;
use crate::contour::{ContourSettings, ContourStatistics, DiagonalTest, ImplicitSurface, Precision, contour};
use crate::edge::{Crossing, Crossings, EdgeNumbers};
use crate::lattice::{Axis, Ijk, LEAF_DIM, Lattice, LeafMask, Slab};
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use std::convert::Infallible;

/// A field whose nodes from `low` to `high` are inside by a rule, and whose other nodes are
/// outside.
pub fn signs(low: Ijk, high: Ijk, inside: impl Fn(Ijk) -> bool) -> SignField {
    let (first, last) = (low.leaf_origin(), high.leaf_origin());
    let steps = |a: usize| (first.0[a]..=last.0[a]).step_by(LEAF_DIM as usize);
    let mut origins = Vec::new();
    for x in steps(0) {
        for y in steps(1) {
            origins.extend(steps(2).map(|z| Ijk::new(x, y, z)));
        }
    }
    let masks: Vec<LeafMask> = origins
        .iter()
        .map(|&origin| {
            let mut mask = [0; 8];
            for n in 0..512 {
                let node = Ijk::in_leaf(origin, n);
                if (0..3).all(|a| (low.0[a]..=high.0[a]).contains(&node.0[a])) && inside(node) {
                    mask[n >> 6] |= 1 << (n & 63);
                }
            }
            mask
        })
        .collect();
    SignField::new(&origins, &masks, Slab::WHOLE, |ring| Ok::<_, Infallible>(vec![false; ring.len()]))
        .unwrap()
}

/// Crossings of all sign changes by a rule of the edge's lower node and axis.
pub fn crossings(signs: &SignField, mut rule: impl FnMut(Ijk, Axis) -> Crossing) -> Crossings {
    let numbers = EdgeNumbers::new(signs).unwrap();
    let mut samples = Vec::with_capacity(numbers.len());
    for leaf in signs.leaves() {
        for (axis, number) in numbers.in_leaf(leaf) {
            samples.push(rule(Ijk::in_leaf(signs.origin(leaf), number), axis));
        }
    }
    Crossings { numbers, samples }
}

/// An implicit surface: negative inside, and its outward unit normal.
pub trait Implicit {
    /// Value and normal at a world position.
    fn at(&self, p: [f64; 3]) -> (f64, [f64; 3]);
    /// Returns the face of the surface that makes the value, where it has several.
    fn face(&self, _: [f64; 3]) -> u32 {
        0
    }
}

impl<F: Fn([f64; 3]) -> (f64, [f64; 3])> Implicit for F {
    fn at(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        self(p)
    }
}

/// Signs and crossings of an implicit surface within the nodes -n..=n, crossings bisected to the
/// last bit.
pub fn sample(surface: &impl Implicit, n: i32, voxel: f64) -> (SignField, Crossings) {
    let world = |node: Ijk, axis: Axis, t: f64| {
        let mut p = node.0.map(f64::from);
        p[axis as usize] += t;
        p.map(|x| x * voxel)
    };
    let value = |node, axis, t| surface.at(world(node, axis, t));
    let field = signs(Ijk([-n; 3]), Ijk([n; 3]), |node| value(node, Axis::X, 0.0).0 < 0.0);
    let crossings = crossings(&field, |node, axis| {
        let low_inside = value(node, axis, 0.0).0 < 0.0;
        let (mut a, mut b) = (0.0, 1.0);
        for _ in 0..60 {
            let t = 0.5 * (a + b);
            if (value(node, axis, t).0 < 0.0) == low_inside { a = t } else { b = t }
        }
        let t = 0.5 * (a + b);
        let normal = value(node, axis, t).1.map(|x| x as f32);
        Crossing { t, normal, triangle: surface.face(world(node, axis, t)) }
    });
    (field, crossings)
}

/// Contours with the diagonals chosen by a test.
pub fn run_by(
    test: DiagonalTest,
    (signs, crossings): &(SignField, Crossings),
    voxel: f64,
    precision: Precision,
) -> (TriMesh, ContourStatistics) {
    let run = RunSettings::with_threads(2).unwrap();
    let settings = ContourSettings { precision, diagonal_test: test, ..Default::default() };
    contour(signs, crossings, Lattice { voxel }, None, &settings, &run).unwrap()
}

/// Contours with a number of threads.
pub fn run(
    (signs, crossings): &(SignField, Crossings),
    voxel: f64,
    precision: Precision,
    threads: usize,
) -> (TriMesh, ContourStatistics) {
    let run = RunSettings::with_threads(threads).unwrap();
    contour(
        signs,
        crossings,
        Lattice { voxel },
        None,
        &ContourSettings { precision, ..ContourSettings::default() },
        &run,
    )
    .unwrap()
}

/// Contours with a surface to ask, and a tolerance in voxels.
pub fn run_with(
    (signs, crossings): &(SignField, Crossings),
    voxel: f64,
    (precision, tolerance): (Precision, Option<f64>),
    threads: usize,
    surface: &dyn ImplicitSurface,
) -> (TriMesh, ContourStatistics) {
    let run = RunSettings::with_threads(threads).unwrap();
    let settings = ContourSettings { precision, tolerance, ..ContourSettings::default() };
    contour(signs, crossings, Lattice { voxel }, Some(surface), &settings, &run).unwrap()
}

/// A small generator of random numbers (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Uniform in 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A unit vector, not quite uniform.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let v: [f64; 3] = std::array::from_fn(|_| 2.0 * self.unit() - 1.0);
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&length) {
                return v.map(|x| x / length);
            }
        }
    }
}
