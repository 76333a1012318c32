//! Pillars below vertices in which parts of the surface touch.
//!
//! Without them the parts would hang together by less than a voxel.

use crate::mesh::TriMesh;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;
use std::collections::HashMap;

/// The pillars of a surface, in a grid of cubes.
#[derive(Debug)]
pub(crate) struct VertexPillars {
    pillars: Vec<Pillar>,
    /// Numbers of the pillars near each cube, ascending. A cube is as wide as a pillar: a larger
    /// one would be near to many.
    near: HashMap<[i32; 3], Vec<u32>>,
    /// Half the length of a pillar, in model units.
    half_length: f64,
    /// Radius of a pillar, in model units.
    radius: f64,
    /// Width of the cubes, in model units.
    cube_width: f64,
}

/// A cylinder around the normal at a vertex, on both sides of the surface.
#[derive(Debug)]
struct Pillar {
    /// The vertex.
    at: DVec3,
    /// Unit normal at the vertex.
    normal: DVec3,
}

impl VertexPillars {
    /// Places a pillar at each vertex in which parts of `surface` touch. Lengths are in model
    /// units.
    pub fn new(surface: &TriMesh, boundary: &Boundary, half_length: f64, radius: f64) -> VertexPillars {
        let cube_width = 2.0 * radius;
        let mut all =
            VertexPillars { pillars: Vec::new(), near: HashMap::new(), half_length, radius, cube_width };
        for &v in &boundary.touching {
            let at = DVec3::from(surface.vertices[v as usize]);
            all.push(Pillar { at, normal: boundary.touching_normal(v) });
        }
        all
    }

    fn push(&mut self, pillar: Pillar) {
        let number = self.pillars.len() as u32;
        // Along each axis of the lattice, each point of the pillar is within `extent` of one of
        // these points of the pillar's axis.
        let count = (2.0 * self.half_length / self.radius).ceil().max(1.0);
        let step = 2.0 * self.half_length / count;
        let extent = self.radius + 0.5 * step;
        for n in 0..=count as u32 {
            let middle = pillar.at + pillar.normal * (f64::from(n) * step - self.half_length);
            let [lo, hi] = [middle - extent, middle + extent].map(|p| self.cube(p));
            for x in lo[0]..=hi[0] {
                for y in lo[1]..=hi[1] {
                    for z in lo[2]..=hi[2] {
                        let near = self.near.entry([x, y, z]).or_default();
                        if near.last() != Some(&number) {
                            near.push(number);
                        }
                    }
                }
            }
        }
        self.pillars.push(pillar);
    }

    fn cube(&self, p: DVec3) -> [i32; 3] {
        (p / self.cube_width).floor().to_array().map(|x| x as i32)
    }

    /// Returns the depth of a point below the vertex of the first pillar that holds it, and the
    /// normal there.
    pub fn at(&self, p: DVec3) -> Option<(f64, DVec3)> {
        if self.pillars.is_empty() {
            return None;
        }
        self.near.get(&self.cube(p))?.iter().find_map(|&n| {
            let &Pillar { at, normal } = &self.pillars[n as usize];
            let across = p - at;
            let depth = -across.dot(normal);
            let is_in = depth.abs() <= self.half_length && (across + normal * depth).length() <= self.radius;
            is_in.then_some((depth, normal))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pillar_is_found_from_everywhere_in_it() {
        // The pillar is somewhere else in its cubes each time.
        for shift in 0..16 {
            let at = DVec3::new(-0.3, 2.35, 7.1) + DVec3::new(0.37, 0.051, 0.029) * f64::from(shift);
            let mut pillars = VertexPillars {
                pillars: Vec::new(),
                near: HashMap::new(),
                half_length: 1.0,
                radius: 0.2,
                cube_width: 0.4,
            };
            pillars.push(Pillar { at, normal: DVec3::X });
            for x in [-0.99, -0.4, 0.0, 0.5, 0.99] {
                for (y, z) in [(0.0, 0.19), (0.19, 0.0), (-0.13, 0.14), (0.0, 0.0)] {
                    let (depth, normal) = pillars.at(at + DVec3::new(x, y, z)).unwrap();
                    assert!((depth + x).abs() < 1e-12 && normal == DVec3::X);
                }
                assert!(pillars.at(at + DVec3::new(x, 0.0, 0.21)).is_none());
            }
            assert!(pillars.at(at + DVec3::new(1.01, 0.0, 0.0)).is_none());
        }
    }
}
