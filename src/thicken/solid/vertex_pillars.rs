//! Rods below vertices in which parts of the surface touch: without them the parts would hang together by less than a voxel.

use crate::mesh::TriMesh;
use crate::thicken::patch::boundary::Boundary;
use glam::DVec3;
use std::collections::HashMap;

/// The rods of a surface, found by place.
#[derive(Debug)]
pub(crate) struct Rods {
    rods: Vec<Rod>,
    /// The rods near each cube, ascending. A cube is as wide as a rod: a larger one would be near to many.
    near: HashMap<[i32; 3], Vec<u32>>,
    /// Half the length of a rod.
    length: f64,
    radius: f64,
    /// Side of the cubes.
    side: f64,
}

#[derive(Debug)]
struct Rod {
    /// The vertex.
    at: DVec3,
    /// The unit normal there.
    normal: DVec3,
}

impl Rods {
    /// Rods of a length and radius in model units.
    pub fn new(surface: &TriMesh, boundary: &Boundary, length: f64, radius: f64) -> Rods {
        let mut all = Rods { rods: Vec::new(), near: HashMap::new(), length, radius, side: 2.0 * radius };
        for &v in &boundary.touching {
            let at = DVec3::from(surface.vertices[v as usize]);
            all.push(Rod { at, normal: boundary.touching_normal(v) });
        }
        all
    }

    fn push(&mut self, rod: Rod) {
        let number = self.rods.len() as u32;
        // Each point of the rod is within `reach` of one of these places on its axis, along each of the lattice's.
        let places = (2.0 * self.length / self.radius).ceil().max(1.0);
        let step = 2.0 * self.length / places;
        let reach = self.radius + 0.5 * step;
        for n in 0..=places as u32 {
            let middle = rod.at + rod.normal * (f64::from(n) * step - self.length);
            let [lo, hi] = [middle - reach, middle + reach].map(|p| self.cube(p));
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
        self.rods.push(rod);
    }

    fn cube(&self, p: DVec3) -> [i32; 3] {
        (p / self.side).floor().to_array().map(|x| x as i32)
    }

    /// The depth of a point in the first rod that it is in, and the normal there.
    pub fn at(&self, p: DVec3) -> Option<(f64, DVec3)> {
        if self.rods.is_empty() {
            return None;
        }
        self.near.get(&self.cube(p))?.iter().find_map(|&n| {
            let &Rod { at, normal } = &self.rods[n as usize];
            let across = p - at;
            let depth = -across.dot(normal);
            let is_in = depth.abs() <= self.length && (across + normal * depth).length() <= self.radius;
            is_in.then_some((depth, normal))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rod_is_found_from_everywhere_in_it() {
        // Somewhere else in its cubes each time.
        for shift in 0..16 {
            let at = DVec3::new(-0.3, 2.35, 7.1) + DVec3::new(0.37, 0.051, 0.029) * f64::from(shift);
            let mut rods =
                Rods { rods: Vec::new(), near: HashMap::new(), length: 1.0, radius: 0.2, side: 0.4 };
            rods.push(Rod { at, normal: DVec3::X });
            for x in [-0.99, -0.4, 0.0, 0.5, 0.99] {
                for (y, z) in [(0.0, 0.19), (0.19, 0.0), (-0.13, 0.14), (0.0, 0.0)] {
                    let (depth, normal) = rods.at(at + DVec3::new(x, y, z)).unwrap();
                    assert!((depth + x).abs() < 1e-12 && normal == DVec3::X);
                }
                assert!(rods.at(at + DVec3::new(x, 0.0, 0.21)).is_none());
            }
            assert!(rods.at(at + DVec3::new(1.01, 0.0, 0.0)).is_none());
        }
    }
}
