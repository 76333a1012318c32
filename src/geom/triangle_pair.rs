//! Exact test whether two triangles meet elsewhere than in the vertices and edges that they share.
//!
//! The signs of determinants decide. Only the point that is returned is rounded.

#[cfg(test)]
pub(crate) mod oracle;
#[cfg(test)]
mod tests;

use super::predicates::{orient2d, orient3d, project, projection_axis};
use glam::DVec3;

type Point = [f64; 3];
type Corners = [Point; 3];

/// Finds a point in which two triangles meet elsewhere than in what they share by vertex number.
///
/// The triangles have the vertex numbers `va` and `vb`, and corners at `pa` and `pb`. `None` if
/// there is no such point, decided exactly; the point itself is rounded. Both triangles must have
/// area and three different vertices. Triangles with three vertices in common always meet.
pub fn meeting_point(va: [u32; 3], pa: Corners, vb: [u32; 3], pb: Corners) -> Option<Point> {
    let mut shared = [(0, 0); 3];
    let mut count = 0;
    for (i, v) in va.iter().enumerate() {
        if let Some(j) = vb.iter().position(|w| v == w) {
            shared[count] = (i, j);
            count += 1;
        }
    }
    match count {
        0 => disjoint(pa, pb),
        1 => at_vertex(rotated(pa, shared[0].0), rotated(pb, shared[0].1)),
        2 => {
            let (i, j) = (3 - shared[0].0 - shared[1].0, 3 - shared[0].1 - shared[1].1);
            folded([pa[shared[0].0], pa[shared[1].0]], pa[i], pb[j])
        }
        _ => Some(centroid(pa)),
    }
}

/// Returns the corners in their cyclic order, beginning with corner `first`.
fn rotated(t: Corners, first: usize) -> Corners {
    [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
}

fn centroid(corners: Corners) -> Point {
    let [a, b, c] = corners.map(DVec3::from);
    ((a + b + c) / 3.0).to_array()
}

/// Returns numbers whose signs are the sides of the plane of `t` that the points are on.
fn sides<const N: usize>(t: Corners, points: [Point; N]) -> [f64; N] {
    points.map(|p| orient3d(t[0], t[1], t[2], p))
}

fn one_side(sides: &[f64]) -> bool {
    sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0)
}

/// Finds a common point of triangles without a common vertex. They meet if and only if an edge of
/// one meets the other.
fn disjoint(a: Corners, b: Corners) -> Option<Point> {
    let b_of_a = sides(a, b);
    if one_side(&b_of_a) {
        return None;
    }
    let a_of_b = sides(b, a);
    if one_side(&a_of_b) {
        return None;
    }
    let edges_of = |t: Corners, side: [f64; 3], other: Corners| {
        (0..3).find_map(|k| {
            let l = (k + 1) % 3;
            segment_meets([t[k], t[l]], [side[k], side[l]], other)
        })
    };
    edges_of(a, a_of_b, b).or_else(|| edges_of(b, b_of_a, a))
}

/// Finds a common point, but for the vertex, of triangles whose first corners are the same vertex.
/// They meet elsewhere if and only if the edge opposite to the vertex of one of them meets the
/// other.
fn at_vertex(a: Corners, b: Corners) -> Option<Point> {
    // Apart from the common corner, a triangle on one side of the other's plane does not meet it.
    let b_of_a = sides(a, [b[1], b[2]]);
    if one_side(&b_of_a) {
        return None;
    }
    let a_of_b = sides(b, [a[1], a[2]]);
    if one_side(&a_of_b) {
        return None;
    }
    segment_meets([a[1], a[2]], a_of_b, b).or_else(|| segment_meets([b[1], b[2]], b_of_a, a))
}

/// Finds a common point, but for the edge, of triangles on a common edge with opposite corners `a`
/// and `b`. They meet elsewhere if and only if they lie in one plane on the same side of the edge.
fn folded(edge: [Point; 2], a: Point, b: Point) -> Option<Point> {
    if orient3d(edge[0], edge[1], a, b) != 0.0 {
        return None;
    }
    let axis = projection_axis([edge[0], edge[1], a])?;
    let side = |p| orient2d(project(edge[0], axis), project(edge[1], axis), project(p, axis));
    ((side(a) > 0.0) == (side(b) > 0.0)).then(|| DVec3::from(edge[0]).midpoint(edge[1].into()).to_array())
}

/// Finds a point in which the closed segment meets the closed triangle. `side` are the sides of the
/// triangle's plane that the segment's ends are on.
fn segment_meets(segment: [Point; 2], side: [f64; 2], t: Corners) -> Option<Point> {
    let [p, q] = segment;
    if one_side(&side) {
        return None;
    }
    let along = if side == [0.0, 0.0] {
        let axis = projection_axis(t)?;
        segment_meets_flat(project(p, axis), project(q, axis), t.map(|x| project(x, axis)))?
    } else {
        let turns = [orient3d(p, q, t[0], t[1]), orient3d(p, q, t[1], t[2]), orient3d(p, q, t[2], t[0])];
        let through = turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0);
        through.then(|| side[0] / (side[0] - side[1]))?
    };
    Some(DVec3::from(p).lerp_monotonic(q.into(), along).to_array())
}

/// Finds a point in which the closed segment pq meets the closed triangle, all in one plane.
/// Returns the point's parameter, from 0 at `p` to 1 at `q`.
fn segment_meets_flat(p: [f64; 2], q: [f64; 2], t: [[f64; 2]; 3]) -> Option<f64> {
    let contains = |x: [f64; 2]| {
        let turns = [orient2d(t[0], t[1], x), orient2d(t[1], t[2], x), orient2d(t[2], t[0], x)];
        turns.iter().all(|&s| s >= 0.0) || turns.iter().all(|&s| s <= 0.0)
    };
    match (contains(p), contains(q)) {
        (true, _) => Some(0.0),
        (_, true) => Some(1.0),
        _ => (0..3).find_map(|k| segments_cross(p, q, t[k], t[(k + 1) % 3])),
    }
}

/// Finds a point in which the closed segments pq and ab in the plane meet. Returns the point's
/// parameter on pq. No end of pq is on a triangle that has ab as an edge: if the segments overlap
/// on a line, then a and b are in pq.
fn segments_cross(p: [f64; 2], q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Option<f64> {
    let (pa, pb) = (orient2d(p, q, a), orient2d(p, q, b));
    let (ap, aq) = (orient2d(a, b, p), orient2d(a, b, q));
    if one_side(&[pa, pb]) || one_side(&[ap, aq]) {
        return None;
    }
    if [pa, pb, ap, aq] != [0.0; 4] {
        return Some(ap / (ap - aq));
    }
    let overlap = (0..2).all(|i| p[i].min(q[i]) <= a[i].max(b[i]) && a[i].min(b[i]) <= p[i].max(q[i]));
    let axis = if (p[0] - q[0]).abs() > (p[1] - q[1]).abs() { 0 } else { 1 };
    overlap.then(|| (a[axis] - p[axis]) / (q[axis] - p[axis]))
}
