//! Planes through space, and what meshes leave on them.

use crate::mesh::TriMesh;
use glam::{DVec2, DVec3};

/// A plane with a frame: x along `right`, y along `up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// The origin of the frame.
    pub origin: DVec3,
    /// Unit vector of x.
    pub right: DVec3,
    /// Unit vector of y.
    pub up: DVec3,
}

impl Plane {
    /// The plane through `origin` that holds `up` and is perpendicular to `normal`, or nearly so.
    pub fn new(origin: DVec3, up: DVec3, normal: DVec3) -> Plane {
        let up = up.try_normalize().unwrap_or(DVec3::Y);
        let normal = (normal - up * normal.dot(up)).try_normalize();
        let normal = normal.unwrap_or_else(|| up.any_orthonormal_vector());
        Plane { origin, right: up.cross(normal), up }
    }

    /// The unit normal, towards the viewer.
    pub fn normal(&self) -> DVec3 {
        self.right.cross(self.up)
    }

    /// The point at (x, y).
    pub fn at(&self, p: DVec2) -> DVec3 {
        self.origin + self.right * p.x + self.up * p.y
    }

    /// The coordinates of the point of the plane below `p`.
    pub fn below(&self, p: DVec3) -> DVec2 {
        DVec2::new((p - self.origin).dot(self.right), (p - self.origin).dot(self.up))
    }
}

/// A piece of a curve on a plane.
pub type Segment = [DVec2; 2];

/// The intersection of a mesh with a plane, as far as it is not farther than `half` from the
/// plane's origin in x or y: a segment per triangle that the plane crosses. A corner on the plane
/// counts as above it, so a closed mesh leaves closed curves.
///
/// # Panics
/// When a vertex number is out of range.
pub fn section(mesh: &TriMesh, plane: &Plane, half: f64) -> Vec<Segment> {
    let normal = plane.normal();
    let mut segments = Vec::new();
    for t in 0..mesh.triangles.len() {
        let corners = mesh.corners(t).map(DVec3::from);
        let heights = corners.map(|c| (c - plane.origin).dot(normal));
        let above = heights.map(|h| h >= 0.0);
        if above[0] == above[1] && above[1] == above[2] {
            continue;
        }
        // The corner that is alone on its side begins both edges that are crossed.
        let alone = (0..3).find(|&k| above[k] != above[(k + 1) % 3] && above[k] != above[(k + 2) % 3]);
        let Some(k) = alone else { continue };
        let crossing = |other: usize| {
            let along = heights[k] / (heights[k] - heights[other]);
            plane.below(corners[k].lerp(corners[other], along))
        };
        segments.extend(clipped([crossing((k + 1) % 3), crossing((k + 2) % 3)], half));
    }
    segments
}

/// The part of a segment in the square of side 2 `half` (Liang and Barsky).
fn clipped([a, b]: Segment, half: f64) -> Option<Segment> {
    let d = b - a;
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        for (towards, room) in [(-d[axis], a[axis] + half), (d[axis], half - a[axis])] {
            if towards == 0.0 && room < 0.0 {
                return None;
            }
            if towards < 0.0 {
                from = from.max(room / towards);
            } else if towards > 0.0 {
                to = to.min(room / towards);
            }
        }
    }
    (from <= to).then(|| [a + d * from, a + d * to])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    fn length(segments: &[Segment]) -> f64 {
        segments.iter().map(|[a, b]| a.distance(*b)).sum()
    }

    #[test]
    fn a_cube_leaves_a_square() {
        // The cube is 2 wide. Through its middle, along lattice lines of its own vertices.
        for origin in [DVec3::ZERO, DVec3::new(0.0, 0.0, 0.3)] {
            let plane = Plane::new(origin, DVec3::Y, DVec3::Z);
            assert_eq!((plane.normal(), plane.right), (DVec3::Z, DVec3::X));
            let cut = section(&shapes::cube(4), &plane, 10.0);
            assert!((length(&cut) - 8.0).abs() < 1e-12, "{}", length(&cut));
            assert!(cut.iter().flatten().all(|p| (p.abs().max_element() - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn a_slanted_plane_leaves_a_hexagon() {
        let plane = Plane::new(DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0), DVec3::ONE);
        let cut = section(&shapes::cube(3), &plane, 10.0);
        assert!((length(&cut) - 6.0 * 2f64.sqrt()).abs() < 1e-9, "{}", length(&cut));
    }

    #[test]
    fn windows_cut_off() {
        let plane = Plane::new(DVec3::X, DVec3::Y, DVec3::Z);
        let cut = section(&shapes::cube(4), &plane, 0.5);
        assert!((length(&cut) - 1.0).abs() < 1e-12);
        let far = Plane { origin: DVec3::X * 5.0, ..plane };
        assert!(section(&shapes::cube(4), &far, 0.5).is_empty());
    }
}
