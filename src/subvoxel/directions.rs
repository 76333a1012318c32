//! Coarse directions of triangles, to find those that face away from each other.

use crate::ssvh::Ssvh;
use glam::DVec3;
use rayon::prelude::*;

/// Size of a unit vector's coordinate up to which it counts as zero. This value makes the 26
/// directions about equally likely.
const ZERO_COORDINATE: f64 = 0.4;

/// A set of directions, a bit for each of 3^3.
pub(super) type Directions = u32;

/// The direction of each triangle of a mesh, and the directions that face away from each.
pub(super) struct DirectionTable {
    by_triangle: Vec<u8>,
    away: [Directions; 27],
}

impl DirectionTable {
    pub(super) fn new(ssvh: &Ssvh, triangles: usize) -> DirectionTable {
        let of = |t| direction(ssvh.triangle(t).normal);
        let by_triangle = (0..triangles as u32).into_par_iter().with_min_len(1 << 12).map(of).collect();
        let away = std::array::from_fn(|a| {
            (0..27).filter(|&b| vector(a).dot(vector(b)) <= 0.0).fold(0, |set, b| set | 1 << b)
        });
        DirectionTable { by_triangle, away }
    }

    /// Returns the direction of a triangle, as a set of one.
    #[inline]
    pub(super) fn of(&self, triangle: u32) -> Directions {
        1 << self.by_triangle[triangle as usize]
    }

    /// Returns the set of the directions of some triangles.
    pub(super) fn of_all(&self, triangles: &[u32]) -> Directions {
        triangles.iter().fold(0, |all, &triangle| all | self.of(triangle))
    }

    /// Whether two directions of a set are at a right angle or more to each other.
    #[inline]
    pub(super) fn disagree(&self, set: Directions) -> bool {
        let mut rest = set;
        while rest != 0 {
            if self.away[rest.trailing_zeros() as usize] & set != 0 {
                return true;
            }
            rest &= rest - 1;
        }
        false
    }
}

fn direction(normal: DVec3) -> u8 {
    let digit = |x: f64| if x > ZERO_COORDINATE { 2 } else { u8::from(x >= -ZERO_COORDINATE) };
    9 * digit(normal.x) + 3 * digit(normal.y) + digit(normal.z)
}

/// Returns the vector in the middle of a direction. The direction of a triangle without a normal is
/// at a right angle to all others.
fn vector(direction: usize) -> DVec3 {
    DVec3::new((direction / 9) as f64, (direction / 3 % 3) as f64, (direction % 3) as f64) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn opposite_faces_disagree() {
        let mesh = (shapes::by_name("box").unwrap().make)(2);
        let table = DirectionTable::new(&Ssvh::new(&mesh), mesh.triangles.len());
        let all = (0..mesh.triangles.len() as u32).fold(0, |set, t| set | table.of(t));
        assert_eq!(all.count_ones(), 6);
        assert!(table.disagree(all));
        assert!(!table.disagree(table.of(0)) && !table.disagree(0));
        assert!(table.disagree(1 << direction(DVec3::X) | 1 << direction(-DVec3::X)));
        let slant = DVec3::new(1.0, 1.0, 0.0).normalize();
        assert!(!table.disagree(1 << direction(DVec3::X) | 1 << direction(slant)));
    }
}
