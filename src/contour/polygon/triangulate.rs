//! The triangles of a polygon around a crossed grid edge: which diagonals, or which fan.

use super::envelope::Envelope;
use super::ju_udeshi;
use crate::contour::feature::CreasePlanes;
use crate::contour::settings::DiagonalTest;
use glam::DVec3;

/// Four cell vertices, and a face vertex between any two of them.
const MAX_CORNERS: usize = 8;

/// The difference in distance from the tangent plane below which two diagonals count as equally
/// good, in voxels. The shorter one is taken then.
///
/// On flat and gently curved parts the distances are noise of the size of the coordinates'
/// rounding, and choosing by noise gives ragged meshes. A crease whose diagonals differ by less is
/// not visible.
const PLANE_TOLERANCE: f64 = 1e-4;

/// The difference in distance from the crease planes below which two diagonals count as equally
/// good, in voxels.
///
/// The faces of a crease may be curved. At radii of 7 voxels the middle of a diagonal is up to this
/// far from the planes at its ends.
const CREASE_TOLERANCE: f64 = 0.05;

/// A corner of a polygon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PolygonCorner {
    /// The number of its vertex.
    pub vertex: u32,
    /// The vertex's rounded position.
    pub position: [f64; 3],
}

/// The polygon around a crossed grid edge, counter-clockwise seen from the edge's outside end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Polygon {
    corners: [PolygonCorner; MAX_CORNERS],
    len: usize,
}

impl Polygon {
    /// Sets four corners.
    #[inline]
    pub fn set_quad(&mut self, corners: [PolygonCorner; 4]) {
        // Corners beyond the last one mean nothing.
        self.corners[..4].copy_from_slice(&corners);
        self.len = 4;
    }

    /// Removes all corners.
    #[inline]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a corner after the others.
    #[inline]
    pub fn push(&mut self, corner: PolygonCorner) {
        self.corners[self.len] = corner;
        self.len += 1;
    }

    /// Returns the corners in order.
    #[inline]
    pub fn corners(&self) -> &[PolygonCorner] {
        &self.corners[..self.len]
    }

    fn remove(&mut self, at: usize) {
        self.corners.copy_within(at + 1..self.len, at);
        self.len -= 1;
    }

    /// Returns the triangle that cutting off corner `at` makes.
    #[inline]
    fn ear(&self, at: usize) -> [PolygonCorner; 3] {
        let n = self.len;
        [self.corners[(at + n - 1) % n], self.corners[at], self.corners[(at + 1) % n]]
    }
}

/// The surface around a crossed grid edge: its tangent plane at the crossing, and the planes of the
/// creases that the cells see.
#[derive(Clone, Copy, Debug)]
pub struct Fit<'a> {
    /// The crossing, unrounded.
    pub point: DVec3,
    /// The unit normal at the crossing.
    pub normal: DVec3,
    /// The planes of creases nearby.
    pub crease_planes: &'a CreasePlanes,
    /// The difference in distance from the crease planes below which two diagonals count as equally
    /// good, in model units.
    pub crease_tolerance: f64,
    /// Difference of distances from the tangent plane, in model units, up to which two diagonals
    /// are equal.
    pub plane_tolerance: f64,
}

impl<'a> Fit<'a> {
    /// Makes the fit for a crossing, on a lattice with the given voxel size in model units.
    pub fn new(point: DVec3, normal: DVec3, crease_planes: &'a CreasePlanes, voxel: f64) -> Fit<'a> {
        let (crease_tolerance, plane_tolerance) = (CREASE_TOLERANCE * voxel, PLANE_TOLERANCE * voxel);
        Fit { point, normal, crease_planes, crease_tolerance, plane_tolerance }
    }

    /// Returns the distances of a diagonal's midpoint from the crease planes and from the tangent
    /// plane, in model units.
    ///
    /// A diagonal along a crease lies in the planes of both its faces. A diagonal across a crease
    /// cuts through the solid or the air.
    fn misfit(&self, diagonal: [[f64; 3]; 2]) -> (f64, f64) {
        let [a, b] = diagonal.map(DVec3::from);
        let middle = 0.5 * (a + b);
        let planes = self.crease_planes;
        let from_creases = if planes.is_empty() { 0.0 } else { planes.distance(middle.to_array()) };
        (from_creases, self.normal.dot(middle - self.point).abs())
    }

    /// Whether the diagonal `second` is closer to the surface than `first`, or as close and
    /// shorter.
    fn prefers(&self, second: [[f64; 3]; 2], first: [[f64; 3]; 2]) -> bool {
        let (a, b) = (self.misfit(first), self.misfit(second));
        if (a.0 - b.0).abs() > self.crease_tolerance {
            return b.0 < a.0;
        }
        if (a.1 - b.1).abs() > self.plane_tolerance {
            return b.1 < a.1;
        }
        length2(second) < length2(first)
    }
}

fn length2(diagonal: [[f64; 3]; 2]) -> f64 {
    let [a, b] = diagonal.map(DVec3::from);
    b.distance_squared(a)
}

/// The way in which a polygon was split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Along diagonals only.
    Diagonals,
    /// Wholly or in part as a fan around a vertex on the grid edge.
    Fan,
}

/// Splits a polygon into triangles that stay in the envelope, and appends these to `triangles`.
///
/// `edge_vertex` is the number of the vertex on the grid edge, if one is needed.
pub fn triangulate_polygon(
    polygon: &Polygon,
    envelope: &Envelope,
    fit: &Fit<'_>,
    test: DiagonalTest,
    edge_vertex: u32,
    triangles: &mut Vec<[u32; 3]>,
) -> Split {
    let diagonal = match test {
        DiagonalTest::ConvexConcave if polygon.len > 4 => {
            return ears(polygon, envelope, fit, edge_vertex, triangles);
        }
        DiagonalTest::ConvexConcave => quad(polygon, fit, is_good(envelope)),
        DiagonalTest::PolygonEdges if polygon.len > 4 => None,
        DiagonalTest::PolygonEdges => quad(polygon, fit, |quad| ju_udeshi::is_legal(quad, envelope)),
    };
    match diagonal {
        Some(pair) => {
            triangles.extend(pair);
            Split::Diagonals
        }
        None => fan(polygon, edge_vertex, triangles),
    }
}

/// Returns the test whether the diagonal from the first to the third corner makes two good
/// triangles.
fn is_good(envelope: &Envelope) -> impl Fn([[f64; 3]; 4]) -> bool {
    |[a, b, c, d]| envelope.is_good(a, b, c) && envelope.is_good(c, d, a)
}

/// Splits a polygon with face vertices: good ears first, the rest as a quad or around the edge's
/// vertex.
fn ears(
    polygon: &Polygon,
    envelope: &Envelope,
    fit: &Fit<'_>,
    edge_vertex: u32,
    triangles: &mut Vec<[u32; 3]>,
) -> Split {
    let first = triangles.len();
    let mut rest = *polygon;
    while rest.len > 4 {
        let Some(ear) = best_ear(&rest, envelope, fit) else { break };
        triangles.push(rest.ear(ear).map(|c| c.vertex));
        rest.remove(ear);
    }
    if rest.len == 4
        && let Some(pair) = quad(&rest, fit, is_good(envelope))
    {
        triangles.extend(pair);
        return Split::Diagonals;
    }
    // The rest goes around the edge's own vertex, as long as its sides still turn around the edge.
    let n = rest.len;
    let turns = |i: usize| envelope.turns(rest.corners[i].position, rest.corners[(i + 1) % n].position);
    if (0..n).all(turns) {
        return fan(&rest, edge_vertex, triangles);
    }
    triangles.truncate(first);
    fan(polygon, edge_vertex, triangles)
}

/// Returns the two triangles of the better legal diagonal of a quad; `None` without a legal one.
///
/// `is_legal` judges the diagonal from the first to the third corner.
#[inline]
fn quad(polygon: &Polygon, fit: &Fit<'_>, is_legal: impl Fn([[f64; 3]; 4]) -> bool) -> Option<[[u32; 3]; 2]> {
    let corner = |i: usize| polygon.corners[i & 3];
    // The diagonal from corner i to corner i + 2.
    let diagonal = |i: usize| [corner(i).position, corner(i + 2).position];
    let first = usize::from(fit.prefers(diagonal(1), diagonal(0)));
    [first, first ^ 1].into_iter().find_map(|i| {
        let [a, b, c, d] = [corner(i), corner(i + 1), corner(i + 2), corner(i + 3)];
        is_legal([a, b, c, d].map(|corner| corner.position))
            .then(|| [[a, b, c], [c, d, a]].map(|triangle| triangle.map(|corner| corner.vertex)))
    })
}

/// Returns the good ear whose diagonal fits the surface best.
fn best_ear(polygon: &Polygon, envelope: &Envelope, fit: &Fit) -> Option<usize> {
    let mut best: Option<(usize, [[f64; 3]; 2])> = None;
    for i in 0..polygon.len {
        let [a, b, c] = polygon.ear(i).map(|c| c.position);
        if envelope.is_good(a, b, c) && best.is_none_or(|(_, other)| fit.prefers([a, c], other)) {
            best = Some((i, [a, c]));
        }
    }
    best.map(|(i, _)| i)
}

/// Splits a polygon into a fan around the vertex on the grid edge.
fn fan(polygon: &Polygon, edge_vertex: u32, triangles: &mut Vec<[u32; 3]>) -> Split {
    let corners = polygon.corners();
    for (i, corner) in corners.iter().enumerate() {
        triangles.push([corner.vertex, corners[(i + 1) % corners.len()].vertex, edge_vertex]);
    }
    Split::Fan
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGE_VERTEX: u32 = 99;

    const ENVELOPE: Envelope = Envelope { above: [0.0, 0.0, 1.0], below: [0.0; 3] };

    fn split(points: &[[f64; 3]], normal: [f64; 3]) -> (Split, Vec<[u32; 3]>) {
        let mut polygon = Polygon::default();
        for (vertex, &position) in (0..).zip(points) {
            polygon.push(PolygonCorner { vertex, position });
        }
        let mut triangles = Vec::new();
        let fit = Fit::new(DVec3::new(0.0, 0.0, 0.5), normal.into(), &CreasePlanes::NONE, 1.0);
        (
            triangulate_polygon(
                &polygon,
                &ENVELOPE,
                &fit,
                DiagonalTest::ConvexConcave,
                EDGE_VERTEX,
                &mut triangles,
            ),
            triangles,
        )
    }

    #[test]
    fn creases_come_out_along_diagonals() {
        // Corners 1 and 3 on a crease, corner 0 on the flat side with the crossing, corner 2 below.
        let points = [[0.5, 0.5, 0.5], [-0.5, 0.4, 0.5], [-0.5, -0.5, 0.1], [0.4, -0.5, 0.5]];
        let (kind, triangles) = split(&points, [0.0, 0.0, 1.0]);
        assert_eq!((kind, triangles), (Split::Diagonals, vec![[1, 2, 3], [3, 0, 1]]));
    }

    #[test]
    fn flat_quads_take_the_shorter_diagonal() {
        let points = [[0.2, 0.2, 0.5], [-0.8, 0.9, 0.5], [-0.2, -0.2, 0.5], [0.9, -0.8, 0.5]];
        assert_eq!(split(&points, [0.0, 0.0, 1.0]).1, [[0, 1, 2], [2, 3, 0]]);
    }

    /// Corners anywhere in their cells: \[LW11\] Remarks 10 and 11.
    #[test]
    fn opposite_corners_are_never_concave_and_neighbours_force_a_split() {
        let mut state = 3u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let (mut splits, mut single) = (0, 0);
        for _ in 0..20_000 {
            let points: [[f64; 3]; 4] = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| {
                // Cubes, to have many close to the edge.
                [x * (1e-3 + random().powi(3)), y * (1e-3 + random().powi(3)), 1e-3 + 0.998 * random()]
            });
            let concave: [bool; 4] = std::array::from_fn(|i| {
                !ENVELOPE.is_good(points[(i + 3) % 4], points[i], points[(i + 1) % 4])
            });
            assert!((0..2).all(|i| !(concave[i] && concave[i + 2])), "{points:?}");
            let (kind, triangles) = split(&points, [0.0, 0.0, 1.0]);
            match concave.iter().filter(|&&c| c).count() {
                2 => {
                    assert_eq!((kind, triangles.len()), (Split::Fan, 4));
                    assert!(triangles.iter().all(|t| t[2] == EDGE_VERTEX));
                    splits += 1;
                }
                count => {
                    assert_eq!((kind, triangles.len()), (Split::Diagonals, 2));
                    single += count;
                }
            }
        }
        assert!(splits > 100 && single > 100, "{splits} {single}");
    }

    #[test]
    fn polygons_with_face_vertices_lose_their_ears() {
        let points =
            [[0.5, 0.5, 0.5], [0.0, 0.4, 0.6], [-0.5, 0.5, 0.5], [-0.5, -0.5, 0.5], [0.5, -0.5, 0.5]];
        let (kind, triangles) = split(&points, [0.0, 0.0, 1.0]);
        assert_eq!((kind, triangles.len()), (Split::Diagonals, 3));
    }
}
