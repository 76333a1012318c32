//! The features by the numbers of their vertices.

use super::crease_planes::{CreasePlanes, CurvatureBound};
use super::locate::Feature;
use super::vertex_set::VertexSet;
use glam::DVec3;

/// A vertex on a crease or a corner.
#[derive(Clone, Copy, Debug)]
pub struct FeatureVertex {
    /// The number of the vertex.
    pub vertex: u32,
    /// The feature: the position of the vertex, and the faces that meet there.
    pub feature: Feature,
}

/// All feature vertices, found by a rank structure over the vertex numbers instead of a hash map.
#[derive(Debug)]
pub struct FeatureMap {
    /// The vertices by ascending number.
    all: Vec<FeatureVertex>,
    /// The numbers.
    vertices: VertexSet,
    /// The number of features before each word of the set.
    before: Vec<u32>,
    bound: CurvatureBound,
}

impl FeatureMap {
    /// Makes the map from a list by ascending number, for a mesh with `vertices` vertices.
    pub fn new(all: Vec<FeatureVertex>, vertices: usize, bound: CurvatureBound) -> FeatureMap {
        let vertices = VertexSet::new(all.iter().map(|feature| feature.vertex), vertices);
        let mut next = 0;
        let mut before = Vec::with_capacity(vertices.words().len());
        for word in vertices.words() {
            before.push(next);
            next += word.count_ones();
        }
        FeatureMap { all, vertices, before, bound }
    }

    /// Returns the feature of a vertex.
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

    /// Whether any of some vertices has a feature.
    #[inline]
    pub fn has_any(&self, vertices: impl IntoIterator<Item = u32>) -> bool {
        self.vertices.contains_any(vertices)
    }

    /// Returns the planes of the features among the vertices of a polygon.
    #[inline]
    pub fn crease_planes(&self, vertices: impl Iterator<Item = u32>) -> CreasePlanes {
        let mut planes = CreasePlanes::new(self.bound);
        if self.all.is_empty() {
            return planes;
        }
        for vertex in vertices {
            let Some(FeatureVertex { feature, .. }) = self.get(vertex) else { continue };
            for normal in feature.normals.iter().filter(|n| **n != [0.0; 3]) {
                planes.push(feature.point, DVec3::from(normal.map(f64::from)));
            }
        }
        planes
    }
}
