//! An embedded mesh whose vertices move only where no intersection arises.
//!
//! A vertex is moved only if its triangles keep an area and their side, and meet neither another
//! triangle nor each other, as in the patches of the [`contour`](crate::contour). Exact
//! predicates decide, on the coordinates that will be written. So the mesh stays embedded, whatever
//! a move is for.

use crate::geom::box_tree::BoxTree;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::meeting_point;
use crate::mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

/// A mesh without intersections whose vertices can be moved.
#[derive(Debug)]
pub(crate) struct Embedding<'a> {
    mesh: &'a mut TriMesh,
    /// Boxes around each triangle as it was at first and after each of its moves.
    tree: BoxTree,
    /// Position of each triangle in the order of the tree.
    positions: Vec<u32>,
    /// Maximum distance of a vertex from its first position along each axis, in model units.
    max_travel: f64,
}

impl<'a> Embedding<'a> {
    /// Wraps a mesh, which must be free of intersections. `max_travel` is in model units.
    pub fn new(mesh: &'a mut TriMesh, max_travel: f64) -> Embedding<'a> {
        let tree =
            BoxTree::new(&mesh.vertices, &mesh.triangles, (0..mesh.triangles.len() as u32).into_par_iter());
        let mut positions = vec![0; mesh.triangles.len()];
        (0..).zip(tree.order()).for_each(|(position, &t)| positions[t as usize] = position);
        Embedding { mesh, tree, positions, max_travel }
    }

    /// Returns the position of a vertex.
    pub fn position(&self, vertex: u32) -> DVec3 {
        DVec3::from(self.mesh.vertices[vertex as usize])
    }

    /// Returns the area vector of a triangle.
    pub fn area(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.mesh.corners(triangle as usize).map(DVec3::from);
        0.5 * (b - a).cross(c - a)
    }

    /// Returns the vertices of a triangle.
    pub fn vertices(&self, triangle: u32) -> [u32; 3] {
        self.mesh.triangles[triangle as usize]
    }

    /// Moves a vertex to `to` if the mesh stays embedded, and returns whether it did.
    ///
    /// `first` is the vertex's first position, `star` are all its triangles. `to` must be rounded
    /// as it will be written.
    pub fn try_move(&mut self, vertex: u32, star: &[u32], first: DVec3, to: DVec3) -> bool {
        if (to - first).abs().max_element() > self.max_travel {
            return false;
        }
        let from = self.mesh.vertices[vertex as usize];
        let before: Vec<DVec3> = star.iter().map(|&t| self.area(t)).collect();
        self.mesh.vertices[vertex as usize] = to.to_array();
        let keeps_side = star.iter().zip(before).all(|(&t, before)| self.area(t).dot(before) > 0.0);
        let fits = keeps_side && self.is_free(star);
        if fits {
            for &t in star {
                self.tree.grow(self.positions[t as usize] as usize, self.bounds(t));
            }
        } else {
            self.mesh.vertices[vertex as usize] = from;
        }
        fits
    }

    /// Whether the triangles of a star have area and meet nothing beyond what they share.
    fn is_free(&self, star: &[u32]) -> bool {
        let mesh = &*self.mesh;
        let meet = |a: u32, b: u32| {
            let [va, vb] = [a, b].map(|t| mesh.triangles[t as usize]);
            meeting_point(va, mesh.corners(a as usize), vb, mesh.corners(b as usize)).is_some()
        };
        let is_sound = |n: usize| {
            projection_axis(mesh.corners(star[n] as usize)).is_some()
                && !star[..n].iter().any(|&other| meet(star[n], other))
        };
        if !(0..star.len()).all(is_sound) {
            return false;
        }
        let boxes: Vec<[DVec3; 2]> = star.iter().map(|&t| self.bounds(t)).collect();
        let all = boxes.iter().copied().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let Some([lo, hi]) = all else { return true };
        let meets_box = |a: &[DVec3; 2], b: &[DVec3; 2]| a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all();
        let mut found = false;
        self.tree.meeting([lo, hi], |other| {
            if found {
                return;
            }
            let around = self.bounds(other);
            let is_near = meets_box(&around, &[lo, hi]) && !star.contains(&other);
            let near = star.iter().zip(&boxes).filter(|(_, own)| is_near && meets_box(&around, own));
            found = near.into_iter().any(|(&t, _)| meet(t, other));
        });
        !found
    }

    /// Returns the lower and the upper corner of the box around a triangle.
    fn bounds(&self, triangle: u32) -> [DVec3; 2] {
        let [a, b, c] = self.mesh.corners(triangle as usize).map(DVec3::from);
        [a.min(b).min(c), a.max(b).max(c)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn a_vertex_goes_where_there_is_room_and_no_farther() {
        let mut cube = (shapes::by_name("box").unwrap().make)(4);
        let first = cube.vertices.len() as u32;
        // A triangle above the face z = 1, and a vertex in the middle of that face.
        cube.vertices.extend([[-0.5, -0.5, 1.3], [0.5, -0.5, 1.3], [0.0, 0.5, 1.3]]);
        cube.triangles.push([first, first + 1, first + 2]);
        let v = (0..first).find(|&v| cube.vertices[v as usize] == [0.0, 0.0, 1.0]).unwrap();
        let star: Vec<u32> =
            (0..cube.triangles.len() as u32).filter(|&t| cube.triangles[t as usize].contains(&v)).collect();
        let mut embedding = Embedding::new(&mut cube, 0.5);
        let from = embedding.position(v);
        let mut to = |z: f64, x: f64| embedding.try_move(v, &star, from, DVec3::new(x, 0.0, z));
        assert!(to(1.2, 0.0));
        assert!(!to(1.35, 0.0), "through the triangle");
        assert!(!to(1.0, 0.6), "out of reach");
        assert!(!to(0.6, 0.1), "a triangle would turn to its other side");
        assert!(to(0.9, 0.05));
        assert_eq!(embedding.position(v), DVec3::new(0.05, 0.0, 0.9));
    }
}
