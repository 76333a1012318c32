//! Minimal-area triangulation of a polygon in space (Barequet and Sharir, \[WC13\] section 4.2):
//! the cap over a hole or a small rim.

use glam::DVec3;
use std::collections::BTreeSet;

/// Maximum number of vertices of a polygon. The time grows with their cube: 160 vertices take some
/// milliseconds.
const MAX_VERTICES: usize = 160;

/// A closed polygon in space.
#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    /// Vertex numbers, in the direction in which the cap's triangles run. A vertex may occur twice.
    pub vertices: Vec<u32>,
    /// Positions of the vertices.
    pub points: Vec<DVec3>,
    /// Triangles that must not be used, by indices into the polygon.
    pub forbidden: BTreeSet<[usize; 3]>,
}

impl Polygon {
    /// Finds the triangulation of least area, by indices into the polygon.
    ///
    /// It has no forbidden triangle, and no diagonal between vertices for which `is_taken`. `None`
    /// when there is no such triangulation.
    pub fn minimal_triangulation(&self, is_taken: impl Fn(u32, u32) -> bool) -> Option<Vec<[usize; 3]>> {
        let n = self.vertices.len();
        if !(3..=MAX_VERTICES).contains(&n) {
            return None;
        }
        // For the polygon from index i to j, closed by the edge (i, j): the least area, and the tip
        // of the triangle at that edge.
        let mut least = vec![(0.0f64, usize::MAX); n * n];
        for span in 2..n {
            for i in 0..n - span {
                let j = i + span;
                let mut best = (f64::INFINITY, usize::MAX);
                let (a, b) = (self.vertices[i], self.vertices[j]);
                let is_edge = span == n - 1;
                if is_edge || a != b && !is_taken(a, b) {
                    for k in i + 1..j {
                        let area = least[i * n + k].0 + least[k * n + j].0 + self.area([i, k, j]);
                        if area < best.0 && !self.forbidden.contains(&[i, k, j]) {
                            best = (area, k);
                        }
                    }
                }
                least[i * n + j] = best;
            }
        }
        if least[n - 1].1 == usize::MAX {
            return None;
        }
        let mut triangles = Vec::with_capacity(n - 2);
        let mut next = vec![(0, n - 1)];
        while let Some((i, j)) = next.pop() {
            if j - i >= 2 {
                let k = least[i * n + j].1;
                triangles.push([i, k, j]);
                next.extend([(i, k), (k, j)]);
            }
        }
        Some(triangles)
    }

    /// Returns the area of a triangle.
    fn area(&self, [i, k, j]: [usize; 3]) -> f64 {
        let [a, b, c] = [i, k, j].map(|n| self.points[n]);
        0.5 * (b - a).cross(c - a).length()
    }

    /// Returns the vertices of a triangle.
    pub fn triangle(&self, indices: [usize; 3]) -> [u32; 3] {
        indices.map(|n| self.vertices[n])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[[f64; 3]]) -> Polygon {
        Polygon {
            vertices: (0..points.len() as u32).collect(),
            points: points.iter().map(|&p| p.into()).collect(),
            forbidden: BTreeSet::new(),
        }
    }

    #[test]
    fn an_l_is_filled_and_nothing_beside_it() {
        let l = [
            [0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 2.0, 0.0],
            [0.0, 2.0, 0.0],
        ];
        let l = polygon(&l);
        let triangles = l.minimal_triangulation(|_, _| false).unwrap();
        assert_eq!(triangles.len(), 4);
        let area: f64 = triangles.iter().map(|&t| l.area(t)).sum();
        assert!((area - 3.0).abs() < 1e-12);
        // The diagonals from the inner corner are all it has: without one of them more area is
        // needed.
        let other = l.minimal_triangulation(|a, b| (a, b) == (0, 3)).unwrap();
        assert!(other.iter().map(|&t| l.area(t)).sum::<f64>() > 2.9);
        assert!(l.minimal_triangulation(|_, _| true).is_none());
    }

    #[test]
    fn forbidden_triangles_are_not_taken() {
        let mut square = polygon(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0]]);
        let first = square.minimal_triangulation(|_, _| false).unwrap();
        square.forbidden.insert(first[0]);
        let second = square.minimal_triangulation(|_, _| false).unwrap();
        assert!(!second.contains(&first[0]) && second.len() == 2);
    }

    #[test]
    fn a_vertex_that_is_there_twice_has_no_diagonal_to_itself() {
        let mut bow = polygon(&[
            [0.0; 3],
            [-1.0, 1.0, 0.0],
            [-1.0, -1.0, 0.0],
            [0.0; 3],
            [1.0, -1.0, 0.0],
            [1.0, 1.0, 0.0],
        ]);
        bow.vertices[3] = 0;
        let triangles = bow.minimal_triangulation(|_, _| false).unwrap();
        assert_eq!(triangles.len(), 4);
        for indices in triangles {
            let [a, b, c] = bow.triangle(indices);
            assert!(a != b && b != c && c != a, "{indices:?}");
        }
    }
}
