//! The vertices on creases and corners, found by number, and what they say of the surface around them.

use super::locate::Feature;
use super::tangent_planes::MAX_PLANES;
use super::vertex_set::VertexSet;
use crate::contour::implicit_surface::{Creases, Surface};
use crate::geom::quadric::dot;

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
    /// Their numbers.
    vertices: VertexSet,
    /// The features before each word of the set.
    before: Vec<u32>,
    bend: Bend,
}

impl Features {
    /// From a list by ascending number, of a mesh with `vertices` vertices.
    pub fn new(all: Vec<FeatureVertex>, vertices: usize, bend: Bend) -> Features {
        let vertices = VertexSet::new(all.iter().map(|feature| feature.vertex), vertices);
        let mut next = 0;
        let mut before = Vec::with_capacity(vertices.words().len());
        for word in vertices.words() {
            before.push(next);
            next += word.count_ones();
        }
        Features { all, vertices, before, bend }
    }

    /// The feature that a vertex stands for.
    #[inline]
    pub fn get(&self, vertex: u32) -> Option<&FeatureVertex> {
        let word = vertex as usize >> 6;
        let bits = *self.vertices.words().get(word)?;
        let bit = 1u64 << (vertex & 63);
        if bits & bit == 0 {
            return None;
        }
        let below = (bits & (bit - 1)).count_ones();
        Some(&self.all[(self.before[word] + below) as usize])
    }

    /// Whether any of some vertices stands for a feature.
    #[inline]
    pub fn has_any(&self, vertices: impl IntoIterator<Item = u32>) -> bool {
        self.vertices.contains_any(vertices)
    }

    /// The sides of the features among the vertices of a polygon.
    #[inline]
    pub fn sides(&self, vertices: impl Iterator<Item = u32>) -> Sides {
        let mut sides = Sides { bend: self.bend, ..Sides::NONE };
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

/// How the surface bends.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    creases: Creases,
    curvature: f64,
}

impl Bend {
    /// How nothing is known of the surface.
    pub const UNKNOWN: Bend = Bend { creases: Creases::Both, curvature: 0.0 };

    /// How a surface bends.
    pub fn of(surface: &dyn Surface) -> Bend {
        Bend { creases: surface.creases(), curvature: surface.curvature() }
    }
}

/// The sides of four features.
const MAX_SIDES: usize = 4 * MAX_PLANES;

/// Planes whose lowest or highest envelope is the surface near a polygon, but for their bend.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    planes: [(Point, Point); MAX_SIDES],
    len: usize,
    bend: Bend,
}

impl Sides {
    /// No sides.
    pub const NONE: Sides = Sides { planes: [([0.0; 3], [0.0; 3]); MAX_SIDES], len: 0, bend: Bend::UNKNOWN };

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The least distance that `p` can have from the surface, in model units, however much the sides are bent.
    pub fn distance(&self, p: Point) -> f64 {
        let Bend { creases, curvature } = self.bend;
        // Of the lower and of the upper ends of what the sides' distances can be.
        let (mut least, mut largest) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (at, normal) in &self.planes[..self.len] {
            let offset = std::array::from_fn(|i| p[i] - at[i]);
            let height = dot(*normal, offset);
            let sag = 0.5 * curvature * dot(offset, offset);
            let ends = match creases {
                Creases::Concave => [height, height + sag],
                Creases::Convex => [height - sag, height],
                Creases::Both => [height; 2],
            };
            for i in 0..2 {
                least[i] = least[i].min(ends[i]);
                largest[i] = largest[i].max(ends[i]);
            }
        }
        let from_zero = |[low, high]: [f64; 2]| low.max(-high).max(0.0);
        match creases {
            Creases::Concave => from_zero(least),
            Creases::Convex => from_zero(largest),
            Creases::Both => from_zero(least).min(from_zero(largest)),
        }
    }
}
