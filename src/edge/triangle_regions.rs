//! The walk of a segment through the regions around a triangle (\[LW11\] section V.B, Definition
//! 4).
//!
//! The seven regions are separated by planes perpendicular to the triangle: one through each edge,
//! and two at the ends of each edge. Each region is convex, so a segment crosses it in one
//! interval.

use crate::geom::triangle::{Feature, Triangle, TriangleSide};
use glam::DVec3;

/// An interval of the segment within one region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// Start and end, as parameters of the segment in 0..=1.
    pub(super) from: f64,
    pub(super) to: f64,
    /// The feature that all points of the interval are closest to.
    pub(super) feature: Feature,
}

/// The most cuts: at three planes through edges, at six planes at the ends of edges, and the two
/// ends of the segment.
const MAX_CUTS: usize = 11;

/// Returns the intervals of the segment p1 p2, in order.
pub(super) fn walk(triangle: &Triangle, p1: DVec3, p2: DVec3) -> impl Iterator<Item = Interval> + '_ {
    let at = move |t: f64| p1 + (p2 - p1) * t;
    let (cuts, count) = cuts(triangle, p1, p2);
    (1..count).filter(move |&i| cuts[i - 1] < cuts[i]).map(move |i| {
        let (from, to) = (cuts[i - 1], cuts[i]);
        Interval { from, to, feature: triangle.feature(at(0.5 * (from + to))) }
    })
}

/// Returns the parameters at which the segment crosses a bounding plane, with 0 and 1, sorted, and
/// their number.
fn cuts(triangle: &Triangle, p1: DVec3, p2: DVec3) -> ([f64; MAX_CUTS], usize) {
    let mut cuts = [0.0; MAX_CUTS];
    cuts[1] = 1.0;
    let mut count = 2;
    let mut cut = |f1: f64, f2: f64| {
        if (f1 < 0.0) != (f2 < 0.0) {
            cuts[count] = f1 / (f1 - f2);
            count += 1;
        }
    };
    let (outside1, outside2) = (triangle.outside(p1), triangle.outside(p2));
    for side in TriangleSide::ALL {
        let k = side.index();
        cut(outside1[k], outside2[k]);
        let edge = triangle.edge(side);
        let along = |p: DVec3| (p - triangle.corners[k]).dot(edge);
        let (along1, along2, length_squared) = (along(p1), along(p2), edge.length_squared());
        cut(along1, along2);
        cut(along1 - length_squared, along2 - length_squared);
    }
    cuts[..count].sort_unstable_by(f64::total_cmp);
    (cuts, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pieces_cover_the_segment_and_name_the_closest_feature(
            corners in prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)),
            p1 in prop::array::uniform3(-2.0..2.0f64),
            p2 in prop::array::uniform3(-2.0..2.0f64),
        ) {
            let triangle = Triangle::new(corners.map(DVec3::from), [0, 1, 2]);
            let (p1, p2) = (DVec3::from(p1), DVec3::from(p2));
            let intervals: Vec<Interval> = walk(&triangle, p1, p2).collect();
            prop_assert_eq!(intervals[0].from, 0.0);
            prop_assert_eq!(intervals[intervals.len() - 1].to, 1.0);
            for pair in intervals.windows(2) {
                prop_assert_eq!(pair[0].to, pair[1].from);
            }
            for interval in intervals.iter().filter(|p| p.to - p.from > 1e-6) {
                for s in [0.01, 0.3, 0.8, 0.99] {
                    let t = interval.from + s * (interval.to - interval.from);
                    prop_assert_eq!(triangle.closest(p1 + (p2 - p1) * t).feature, interval.feature);
                }
            }
        }
    }
}
