//! Faces of any number of corners, collected in the file's order and triangulated at the end.
//!
//! How a polygon is cut:
//! - Three corners are a triangle. One or two corners become a degenerate triangle, which
//!   [`clean`](crate::mesh::clean) drops and counts. None is nothing.
//! - Four corners: along the shorter of the diagonals that leave two triangles of like orientation.
//! - More: ears are cut off one after the other. An ear turns the way the polygon does and no other
//!   corner lies in it or on its edges. So concave planar polygons do not fold, and a corner in the
//!   middle of a straight side stays a corner of a proper triangle, as the neighbour across that
//!   side needs it.
//!
//! Orientation is judged in the projection along the largest component of the polygon's normal,
//! exactly (`robust`). A polygon without an ear (it crosses itself or has no area) is finished as a
//! fan.

use robust::{Coord, orient2d};

use crate::mesh::TriMesh;

/// Beyond this many corners a polygon is cut as a fan: ears take quadratic time at best, and real
/// faces have far fewer corners.
const MOST_CORNERS_FOR_EARS: usize = 4096;

/// A mesh in the making, whose faces are polygons.
#[derive(Default)]
pub(super) struct PolygonMesh {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Polygons of four and more corners, which wait for the vertices.
    polygons: Vec<Polygon>,
    corners: Vec<u32>,
}

/// A polygon of [`PolygonMesh::corners`].
struct Polygon {
    /// Number of triangles before the polygon.
    position: usize,
    /// First corner of the polygon; the last one is before the first of the next polygon.
    first: usize,
}

impl PolygonMesh {
    /// Appends a face.
    pub(super) fn push(&mut self, corners: &[u32]) {
        match *corners {
            [] => {}
            [a] => self.triangles.push([a, a, a]),
            [a, b] => self.triangles.push([a, b, b]),
            [a, b, c] => self.triangles.push([a, b, c]),
            _ => {
                self.polygons.push(Polygon { position: self.triangles.len(), first: self.corners.len() });
                self.corners.extend_from_slice(corners);
            }
        }
    }

    /// Drops the vertices with a coordinate that is not finite, and appends their numbers to
    /// `gone`; and the faces that have one of them, and returns how many.
    pub(super) fn drop_non_finite(&mut self, gone: &mut Vec<u32>) -> usize {
        /// The number of a vertex that is dropped. No mesh has as many.
        const GONE: u32 = u32::MAX;
        let mut numbers = Vec::with_capacity(self.vertices.len());
        let mut next = 0;
        for (v, position) in (0..).zip(&self.vertices) {
            let is_finite = position.iter().all(|x| x.is_finite());
            numbers.push(if is_finite { next } else { GONE });
            match is_finite {
                true => next += 1,
                false => gone.push(v),
            }
        }
        let old = std::mem::take(self);
        let (mut faces, mut kept) = (0, Vec::new());
        let mut keep = |corners: &[u32]| {
            kept.clear();
            kept.extend(corners.iter().map(|&v| numbers[v as usize]));
            match kept.contains(&GONE) {
                true => faces += 1,
                false => self.push(&kept),
            }
        };
        let mut done = 0;
        for (i, polygon) in old.polygons.iter().enumerate() {
            old.triangles[done..polygon.position].iter().for_each(|t| keep(t));
            done = polygon.position;
            keep(old.polygon(i));
        }
        old.triangles[done..].iter().for_each(|t| keep(t));
        self.vertices = old.vertices;
        self.vertices.retain(|position| position.iter().all(|x| x.is_finite()));
        faces
    }

    /// The corners of a polygon.
    fn polygon(&self, i: usize) -> &[u32] {
        let end = self.polygons.get(i + 1).map_or(self.corners.len(), |next| next.first);
        &self.corners[self.polygons[i].first..end]
    }

    /// The mesh, with all polygons triangulated. Every corner must be a vertex.
    pub(super) fn finish(self) -> TriMesh {
        if self.polygons.is_empty() {
            return TriMesh { vertices: self.vertices, triangles: self.triangles };
        }
        // A polygon of n corners makes n - 2 triangles.
        let count = self.triangles.len() + self.corners.len() - 2 * self.polygons.len();
        let mut all = Vec::with_capacity(count);
        let mut done = 0;
        for (i, polygon) in self.polygons.iter().enumerate() {
            all.extend_from_slice(&self.triangles[done..polygon.position]);
            done = polygon.position;
            triangulate(self.polygon(i), &self.vertices, &mut all);
        }
        all.extend_from_slice(&self.triangles[done..]);
        TriMesh { vertices: self.vertices, triangles: all }
    }
}

/// Cuts a polygon of at least four corners into triangles.
fn triangulate(corners: &[u32], vertices: &[[f64; 3]], triangles: &mut Vec<[u32; 3]>) {
    let points: Vec<[f64; 3]> = corners.iter().map(|&v| vertices[v as usize]).collect();
    let flat = project(&points);
    if let [a, b, c, d] = *corners {
        let fits = |i: [usize; 3], k: [usize; 3]| turn(&flat, i) > 0.0 && turn(&flat, k) > 0.0;
        let ac = fits([0, 1, 2], [0, 2, 3]);
        let bd = fits([0, 1, 3], [1, 2, 3]);
        let shorter = square(points[1], points[3]) < square(points[0], points[2]);
        match bd && (shorter || !ac) {
            true => triangles.extend([[a, b, d], [b, c, d]]),
            false => triangles.extend([[a, b, c], [a, c, d]]),
        }
        return;
    }
    let mut ring: Vec<usize> = (0..corners.len()).collect();
    if corners.len() <= MOST_CORNERS_FOR_EARS {
        cut_ears(&flat, &mut ring, |ear| triangles.push(ear.map(|i| corners[i])));
    }
    triangles.extend(ring[1..].windows(2).map(|w| [ring[0], w[0], w[1]].map(|i| corners[i])));
}

/// Cuts ears off the `ring` until three corners are left, or none of the corners is an ear.
fn cut_ears(flat: &[Coord<f64>], ring: &mut Vec<usize>, mut emit: impl FnMut([usize; 3])) {
    let corner = |ring: &[usize], k: usize| {
        let n = ring.len();
        [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]]
    };
    // Only corners that do not turn the polygon's way can lie in an ear, and cutting ears does not
    // make new ones.
    let blunt: Vec<usize> =
        (0..ring.len()).filter(|&k| turn(flat, corner(ring, k)) <= 0.0).map(|k| ring[k]).collect();
    let (mut k, mut refused) = (0, 0);
    while ring.len() > 3 && refused < ring.len() {
        k %= ring.len();
        let ear = corner(ring, k);
        if turn(flat, ear) > 0.0 && !blunt.iter().any(|&p| covers(flat, ear, p)) {
            emit(ear);
            ring.remove(k);
            refused = 0;
        } else {
            refused += 1;
        }
        // Going on behind the ear, not beside it, keeps the triangles from becoming a fan of
        // slivers.
        k += 1;
    }
}

/// Whether `p` lies in the triangle or on its edges, its corners excepted.
fn covers(flat: &[Coord<f64>], [a, b, c]: [usize; 3], p: usize) -> bool {
    let is_corner = |i: usize| flat[i].x == flat[p].x && flat[i].y == flat[p].y;
    !(is_corner(a) || is_corner(b) || is_corner(c))
        && turn(flat, [a, b, p]) >= 0.0
        && turn(flat, [b, c, p]) >= 0.0
        && turn(flat, [c, a, p]) >= 0.0
}

/// Twice the signed area of a triangle; its sign is exact.
fn turn(flat: &[Coord<f64>], [a, b, c]: [usize; 3]) -> f64 {
    orient2d(flat[a], flat[b], flat[c])
}

/// The polygon in the coordinate plane in which it is largest, counter-clockwise.
fn project(points: &[[f64; 3]]) -> Vec<Coord<f64>> {
    // Newell: the components are twice the areas of the three projections. Relative to the first
    // corner, so that a small polygon far from the origin keeps its digits.
    let relative = |i: usize| -> [f64; 3] {
        let p = points[i % points.len()];
        std::array::from_fn(|a| p[a] - points[0][a])
    };
    let mut normal = [0.0f64; 3];
    for i in 0..points.len() {
        let (p, q) = (relative(i), relative(i + 1));
        for (a, component) in normal.iter_mut().enumerate() {
            let (u, v) = ((a + 1) % 3, (a + 2) % 3);
            *component += p[u] * q[v] - p[v] * q[u];
        }
    }
    let axis = (0..3).fold(0, |best, a| if normal[a].abs() > normal[best].abs() { a } else { best });
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    points.iter().map(|p| Coord { x: p[u], y: p[v] }).collect()
}

/// The squared distance of two points.
fn square(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|a| (p[a] - q[a]).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles of the plane polygon `outline`, checked: all turn left, they fill its area,
    /// and each side belongs to exactly one of them.
    fn check(outline: &[[f64; 2]]) -> Vec<[u32; 3]> {
        let n = outline.len() as u32;
        let vertices = outline.iter().map(|p| [p[0], p[1], 3.0 + 0.5 * p[0]]).collect();
        let mut mesh = PolygonMesh { vertices, ..PolygonMesh::default() };
        mesh.push(&(0..n).collect::<Vec<_>>());
        let mesh = mesh.finish();
        assert_eq!(mesh.triangles.len(), outline.len() - 2);
        let area = |p: &[[f64; 2]]| -> f64 {
            (0..p.len()).map(|i| (p[i], p[(i + 1) % p.len()])).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum()
        };
        let areas: Vec<f64> = mesh.triangles.iter().map(|t| area(&t.map(|v| outline[v as usize]))).collect();
        assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - area(outline)).abs() < 1e-12);
        for a in 0..n {
            let b = (a + 1) % n;
            let sides = mesh.triangles.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
            assert_eq!(sides.filter(|side| *side == [a, b]).count(), 1);
        }
        mesh.triangles
    }

    #[test]
    fn a_quad_is_cut_along_its_shorter_diagonal() {
        assert_eq!(check(&[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [1.0, 1.0]]), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(check(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_dart_is_cut_at_its_reflex_corner_from_every_start() {
        let dart = [[0.0, 0.0], [4.0, -4.0], [1.0, 0.0], [4.0, 4.0]];
        for start in 0..4 {
            let mut turned = dart;
            turned.rotate_left(start);
            check(&turned);
        }
    }

    #[test]
    fn concave_polygons_and_straight_corners_do_not_fold() {
        // A comb.
        let comb = [
            [0.0, 0.0],
            [6.0, 0.0],
            [6.0, 3.0],
            [5.0, 3.0],
            [5.0, 1.0],
            [4.0, 1.0],
            [4.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [2.0, 1.0],
            [2.0, 3.0],
            [0.0, 3.0],
        ];
        // A square whose sides have corners in their middle.
        let straight =
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
        // A triangle with five corners.
        let triangle = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [4.0, 0.0], [0.0, 3.0]];
        for start in 0..12 {
            let turned = |outline: &[[f64; 2]]| {
                let mut turned = outline.to_vec();
                turned.rotate_left(start % outline.len());
                turned
            };
            check(&turned(&comb));
            check(&turned(&straight));
            check(&turned(&triangle));
        }
        // Every second corner is blunt, in the largest polygon that is cut by ears.
        let star = |i: usize| {
            let (angle, radius) = (i as f64 * 0.0015339, if i.is_multiple_of(2) { 1.0 } else { 0.7 });
            [radius * angle.cos(), radius * angle.sin()]
        };
        check(&(0..MOST_CORNERS_FOR_EARS).map(star).collect::<Vec<_>>());
        let circle: Vec<_> = (0..50).map(|i| f64::from(i) * 0.125).map(|t| [t.cos(), t.sin()]).collect();
        check(&circle);
    }

    #[test]
    fn polygons_without_area_still_become_triangles_of_their_corners() {
        for outline in [vec![[0.0; 3]; 6], (0..6).map(|i| [f64::from(i), 0.0, 0.0]).collect()] {
            let mut mesh = PolygonMesh { vertices: outline, ..PolygonMesh::default() };
            mesh.push(&[0, 1, 2, 3, 4, 5]);
            mesh.push(&[0, 1, 2, 3]);
            mesh.push(&[4, 5]);
            mesh.push(&[]);
            let triangles = mesh.finish().triangles;
            assert_eq!(triangles.len(), 4 + 2 + 1);
        }
    }
}
