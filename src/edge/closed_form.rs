//! Closed forms of the root on a segment for one triangle (\[LW11\] section V.B, Remarks 5, 6 and
//! 7).

use super::triangle_regions::{Interval, walk};
use crate::geom::roots::quadratic;
use crate::geom::triangle::{Feature, Triangle};
use glam::DVec3;

/// Parameter beyond an interval's ends up to which a root still belongs to the interval. Two
/// neighbouring intervals round the plane between them differently.
const INTERVAL_OVERLAP: f64 = 1e-9;

/// Returns the first parameter in 0..=1 at which the point p1 + t (p2 - p1) is at the offset
/// distance `r` from `triangle`: outside for r > 0, inside for r < 0 (by the triangle's normal), on
/// it for 0. Distances from edges and vertices have no sign of their own; the caller verifies the
/// root against the whole mesh.
pub(super) fn root(triangle: &Triangle, p1: DVec3, p2: DVec3, r: f64) -> Option<f64> {
    let (feature1, feature2) = (triangle.feature(p1), triangle.feature(p2));
    if feature1 == feature2 {
        // Regions are convex: the whole segment is in this one.
        return in_region(triangle, p1, p2, r, Interval { from: 0.0, to: 1.0, feature: feature1 });
    }
    walk(triangle, p1, p2).find_map(|interval| in_region(triangle, p1, p2, r, interval))
}

fn in_region(triangle: &Triangle, p1: DVec3, p2: DVec3, r: f64, interval: Interval) -> Option<f64> {
    let direction = p2 - p1;
    let within = |t: &f64| (interval.from - INTERVAL_OVERLAP..=interval.to + INTERVAL_OVERLAP).contains(t);
    let root = match interval.feature {
        // Remark 5: the distance from the plane is linear along the segment.
        Feature::Face => {
            let slope = direction.dot(triangle.normal);
            let t = (r - (p1 - triangle.corners[0]).dot(triangle.normal)) / slope;
            Some(t).filter(within)
        }
        // Remark 6: the squared distance from the edge's line is quadratic. The components along
        // the edge are taken off, which is the paper's two projections in one.
        Feature::Edge(side) => {
            let edge = triangle.edge(side).normalize();
            let across = |v: DVec3| v - edge * v.dot(edge);
            level(across(p1 - triangle.corners[side.index()]), across(direction), r, within)
        }
        // Remark 7: the segment meets a sphere.
        Feature::Vertex(side) => level(p1 - triangle.corners[side.index()], direction, r, within),
    };
    root.map(|t| t.clamp(0.0, 1.0))
}

/// Returns the first t with |start + t direction| = |r| that `within` accepts.
fn level(start: DVec3, direction: DVec3, r: f64, within: impl Fn(&f64) -> bool) -> Option<f64> {
    let (a, b) = (direction.length_squared(), 2.0 * start.dot(direction));
    quadratic(a, b, start.length_squared() - r * r).find(within)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit() -> Triangle {
        Triangle::new([DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)], [0, 1, 2])
    }

    #[test]
    fn closed_forms_of_the_three_remarks() {
        let t = unit();
        // Remark 5: straight above the face, outside and inside.
        let up = (DVec3::new(1.0, 1.0, -2.0), DVec3::new(1.0, 1.0, 2.0));
        assert_eq!(root(&t, up.0, up.1, 1.0), Some(0.75));
        assert_eq!(root(&t, up.0, up.1, -1.0), Some(0.25));
        assert_eq!(root(&t, up.0, up.1, 0.0), Some(0.5));
        // Remark 6: beside edge 0 (along x), 3-4-5.
        let beside = root(&t, DVec3::new(2.0, -3.0, 0.0), DVec3::new(2.0, -3.0, 8.0), 5.0).unwrap();
        assert!((beside - 0.5).abs() < 1e-15);
        // Remark 7: towards the right-angled corner.
        let corner = root(&t, DVec3::new(-1.0, -2.0, 0.0), DVec3::new(-1.0, -2.0, 4.0), 3.0).unwrap();
        assert!((corner - 0.5).abs() < 1e-15);
    }

    #[test]
    fn a_distance_that_is_not_reached_has_no_root() {
        assert_eq!(root(&unit(), DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 1.0, 3.0), 1.0), None);
        assert_eq!(root(&unit(), DVec3::new(1.0, 1.0, 2.0), DVec3::new(1.0, 1.0, 3.0), 0.0), None);
    }

    proptest! {
        #[test]
        fn the_root_is_at_the_offset_distance(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            p1 in prop::array::uniform3(-3.0..3.0f64),
            p2 in prop::array::uniform3(-3.0..3.0f64),
            level in 0.05..0.95f64,
        ) {
            let triangle = Triangle::new(corners.map(DVec3::from), [0, 1, 2]);
            let (p1, p2) = (DVec3::from(p1), DVec3::from(p2));
            prop_assume!(triangle.normal != DVec3::ZERO);
            let distance = |p: DVec3| triangle.distance_squared(p).sqrt();
            let side = |p: DVec3| (p - triangle.corners[0]).dot(triangle.normal) > 0.0;
            prop_assume!(side(p1) && side(p2));
            let (d1, d2) = (distance(p1), distance(p2));
            let r = d1 + level * (d2 - d1);
            let t = root(&triangle, p1, p2, r);
            prop_assert!(t.is_some(), "{} {} {}", d1, r, d2);
            prop_assert!((distance(p1 + (p2 - p1) * t.unwrap()) - r).abs() < 1e-9);
        }
    }
}
