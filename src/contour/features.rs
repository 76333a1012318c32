//! The vertices on creases and corners, found by number, and what they say of the surface around them.

use super::feature::{Feature, MAX_PLANES};
use super::qef::dot;
use super::surface::Creases;

type Point = [f64; 3];

/// A vertex on a crease or a corner.
#[derive(Clone, Copy, Debug)]
pub struct FeatureVertex {
    /// Its number.
    pub vertex: u32,
    /// Where it belongs, and the sides that meet there.
    pub feature: Feature,
}

/// All of them, with a rank structure over the vertex numbers instead of a hash map.
#[derive(Debug)]
pub struct Features {
    /// By ascending number.
    all: Vec<FeatureVertex>,
    /// A bit for each vertex.
    bits: Vec<u64>,
    /// The features before each word of `bits`.
    before: Vec<u32>,
    creases: Creases,
}

impl Features {
    /// From a list by ascending number, of a mesh with `vertices` vertices
    /// and creases of a kind.
    pub fn new(all: Vec<FeatureVertex>, vertices: usize, creases: Creases) -> Features {
        if all.is_empty() {
            return Features { all, bits: Vec::new(), before: Vec::new(), creases };
        }
        let mut bits = vec![0u64; vertices.div_ceil(64)];
        for feature in &all {
            bits[feature.vertex as usize >> 6] |= 1 << (feature.vertex & 63);
        }
        let mut next = 0;
        let mut before = Vec::with_capacity(bits.len());
        for word in &bits {
            before.push(next);
            next += word.count_ones();
        }
        Features { all, bits, before, creases }
    }

    /// The feature that a vertex stands for.
    #[inline]
    pub fn get(&self, vertex: u32) -> Option<&FeatureVertex> {
        let word = vertex as usize >> 6;
        let bits = *self.bits.get(word)?;
        let bit = 1u64 << (vertex & 63);
        if bits & bit == 0 {
            return None;
        }
        let below = (bits & (bit - 1)).count_ones();
        Some(&self.all[(self.before[word] + below) as usize])
    }

    /// The sides of the features among the vertices of a polygon.
    #[inline]
    pub fn sides(&self, vertices: impl Iterator<Item = u32>) -> Sides {
        let mut sides = Sides { creases: self.creases, ..Sides::NONE };
        if self.all.is_empty() {
            return sides;
        }
        for vertex in vertices {
            let Some(FeatureVertex { feature, .. }) = self.get(vertex) else { continue };
            for normal in feature.normals.iter().filter(|n| **n != [0.0; 3]) {
                if sides.len < MAX_SIDES {
                    sides.planes[sides.len] = (feature.point, normal.map(f64::from));
                    sides.len += 1;
                }
            }
        }
        sides
    }
}

/// The sides of four features.
const MAX_SIDES: usize = 4 * MAX_PLANES;

/// Planes whose lowest or highest envelope is the surface near a polygon.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    planes: [(Point, Point); MAX_SIDES],
    len: usize,
    creases: Creases,
}

impl Sides {
    /// No sides.
    pub const NONE: Sides =
        Sides { planes: [([0.0; 3], [0.0; 3]); MAX_SIDES], len: 0, creases: Creases::Both };

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The distance of `p` from the envelope, in model units: off by about the square of its distance from the
    /// features over twice the radius of curvature.
    pub fn distance(&self, p: Point) -> f64 {
        let heights = self.planes[..self.len].iter().map(|(at, normal)| {
            let offset = std::array::from_fn(|i| p[i] - at[i]);
            dot(*normal, offset)
        });
        let (least, largest) =
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        match self.creases {
            Creases::Concave => least.abs(),
            Creases::Convex => largest.abs(),
            Creases::Both => least.abs().min(largest.abs()),
        }
    }
}
