//! A small software rasteriser: triangles into a depth buffer, seen in parallel projection.

use super::plane::Plane;
use crate::mesh::TriMesh;
use glam::{DVec2, DVec3};

/// A camera: the picture plane, seen against its normal, and half the width of the
/// picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// The middle of the picture and its directions.
    pub plane: Plane,
    /// From the middle of the picture to its border, in model units.
    pub half: f64,
}

/// The triangle that one pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The triangle.
    pub triangle: u32,
    /// Height above the picture plane, towards the viewer.
    pub height: f64,
    /// Distance to the nearest edge of the triangle, in pixels.
    pub edge: f64,
}

/// A square picture of the nearest triangles.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Pixels along a side.
    pub size: usize,
    /// Row by row from the top.
    pub pixels: Vec<Option<Hit>>,
}

impl Camera {
    /// Sees a square of side 2 `half` around `middle` from the direction `towards`, with `up`
    /// upwards.
    pub fn at(middle: DVec3, half: f64, towards: DVec3, up: DVec3) -> Camera {
        let towards = towards.try_normalize().unwrap_or(DVec3::Z);
        let up = (up - towards * up.dot(towards)).try_normalize();
        let up = up.unwrap_or_else(|| towards.any_orthonormal_vector());
        Camera { plane: Plane::new(middle, up, towards), half }
    }

    /// Sees the whole of a mesh from the direction `towards`, with `up` upwards.
    pub fn around(mesh: &TriMesh, towards: DVec3, up: DVec3) -> Camera {
        let mut plane = Camera::at(DVec3::ZERO, 1.0, towards, up).plane;
        let seen = || mesh.vertices.iter().map(|&v| plane.below(v.into()));
        let lo = seen().fold(DVec2::INFINITY, DVec2::min);
        let hi = seen().fold(DVec2::NEG_INFINITY, DVec2::max);
        // A margin, so that the outline is not cut; and some size for a mesh without vertices.
        let half = (0.52 * (hi - lo).max_element()).max(f64::MIN_POSITIVE);
        let middle = lo.midpoint(hi);
        plane.origin = if middle.is_finite() { plane.at(middle) } else { DVec3::ZERO };
        Camera { plane, half }
    }

    /// Returns the point of a pixel's middle on the picture plane.
    pub fn on_plane(&self, column: usize, row: usize, size: usize) -> DVec2 {
        let scale = 2.0 * self.half / size as f64;
        DVec2::new((column as f64 + 0.5) * scale - self.half, self.half - (row as f64 + 0.5) * scale)
    }

    /// The point that a pixel shows.
    pub fn point(&self, column: usize, row: usize, size: usize, hit: &Hit) -> DVec3 {
        self.plane.at(self.on_plane(column, row, size)) + self.plane.normal() * hit.height
    }
}

/// Draws a mesh. Triangles whose back is seen are drawn, too: of a closed mesh none is in front.
///
/// # Panics
/// When a vertex number is out of range.
pub fn raster(mesh: &TriMesh, camera: &Camera, size: usize) -> Frame {
    let mut frame = Frame { size, pixels: vec![None; size * size] };
    let normal = camera.plane.normal();
    let scale = size as f64 / (2.0 * camera.half);
    let projected: Vec<DVec3> = mesh
        .vertices
        .iter()
        .map(|&v| {
            let v = DVec3::from(v);
            let p = camera.plane.below(v);
            let (x, y) = ((p.x + camera.half) * scale, (camera.half - p.y) * scale);
            DVec3::new(x, y, (v - camera.plane.origin).dot(normal))
        })
        .collect();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        frame.fill(triangle.map(|v| projected[v as usize]), t as u32);
    }
    frame
}

impl Frame {
    /// Fills the pixels whose middle lies in a triangle, with corners in pixels and heights.
    fn fill(&mut self, corners: [DVec3; 3], triangle: u32) {
        let flat = corners.map(|c| c.truncate());
        let lo = flat[0].min(flat[1]).min(flat[2]);
        let hi = flat[0].max(flat[1]).max(flat[2]);
        let size = self.size as f64;
        let area = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        // Written so that NaN is left out.
        let seen = hi.x >= 0.0 && hi.y >= 0.0 && lo.x <= size && lo.y <= size && area != 0.0;
        if !seen {
            return;
        }
        let first = |x: f64| (x - 0.5).ceil().max(0.0) as usize;
        let last = |x: f64| (x + 0.5).floor().clamp(0.0, size) as usize;
        // Barycentric weights times the altitude are distances from the edges.
        let altitudes: [f64; 3] = std::array::from_fn(|k| {
            let opposite = flat[(k + 2) % 3].distance(flat[(k + 1) % 3]);
            area.abs() / opposite
        });
        for row in first(lo.y)..last(hi.y) {
            for column in first(lo.x)..last(hi.x) {
                let p = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let weight = |k: usize| (flat[(k + 1) % 3] - p).perp_dot(flat[(k + 2) % 3] - p) / area;
                let weights: [f64; 3] = std::array::from_fn(weight);
                if weights.iter().any(|w| *w < 0.0) {
                    continue;
                }
                let height = (0..3).map(|k| weights[k] * corners[k].z).sum();
                let pixel = &mut self.pixels[row * self.size + column];
                if pixel.is_none_or(|hit| height > hit.height) {
                    let edge = (0..3).map(|k| weights[k] * altitudes[k]).fold(f64::INFINITY, f64::min);
                    *pixel = Some(Hit { triangle, height, edge });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(z: f64) -> TriMesh {
        let vertices = vec![[-1.0, -1.0, z], [1.0, -1.0, z], [-1.0, 1.0, z]];
        TriMesh { vertices, triangles: vec![[0, 1, 2]] }
    }

    fn front() -> Camera {
        Camera { plane: Plane::new(DVec3::ZERO, DVec3::Y, DVec3::Z), half: 1.0 }
    }

    #[test]
    fn a_triangle_fills_half_of_the_picture() {
        let size = 64;
        let frame = raster(&triangle(0.25), &front(), size);
        let filled = frame.pixels.iter().flatten().count();
        // The diagonal's pixels have their middle on it and count.
        assert_eq!(filled, size * (size + 1) / 2);
        assert!(frame.pixels[0].is_some() && frame.pixels[size - 1].is_none(), "the hypotenuse is up right");
        let hit = frame.pixels[(size - 1) * size].unwrap();
        assert_eq!((hit.triangle, hit.height), (0, 0.25));
        assert!((hit.edge - 0.5).abs() < 1e-9, "{}", hit.edge);
        let point = front().point(0, size - 1, size, &hit);
        assert!(point.distance(DVec3::new(-1.0 + 1.0 / 64.0, -1.0 + 1.0 / 64.0, 0.25)) < 1e-12);
    }

    #[test]
    fn the_nearer_one_is_seen() {
        let mut both = triangle(-0.5);
        let near = triangle(0.5);
        both.vertices.extend(near.vertices);
        for triangles in [[[0, 1, 2], [3, 4, 5]], [[3, 4, 5], [0, 1, 2]]] {
            both.triangles = triangles.into();
            let frame = raster(&both, &front(), 16);
            assert!(frame.pixels.iter().flatten().all(|hit| hit.height == 0.5));
        }
    }

    #[test]
    fn what_is_outside_or_edge_on_is_left_out() {
        let camera = Camera { plane: Plane::new(DVec3::X * 9.0, DVec3::Y, DVec3::Z), half: 1.0 };
        assert_eq!(raster(&triangle(0.0), &camera, 8).pixels.iter().flatten().count(), 0);
        let side = Camera { plane: Plane::new(DVec3::ZERO, DVec3::Y, DVec3::X), half: 1.0 };
        assert_eq!(raster(&triangle(0.0), &side, 8).pixels.iter().flatten().count(), 0);
    }

    #[test]
    fn cameras_see_the_whole_mesh() {
        let mut mesh = crate::mesh::shapes::cube(2);
        mesh.vertices.iter_mut().for_each(|v| v[0] += 10.0);
        let camera = Camera::around(&mesh, DVec3::ONE, DVec3::Z);
        assert!(camera.half > 1.41 && camera.half < 1.75, "{}", camera.half);
        assert!(camera.plane.normal().dot(DVec3::ONE.normalize()) > 0.999_999);
        assert!(camera.plane.up.z > 0.5);
        let seen = raster(&mesh, &camera, 64);
        assert!(seen.pixels[64 * 32 + 32].is_some() && seen.pixels[0].is_none());
        assert_eq!(
            raster(&TriMesh::default(), &Camera::around(&TriMesh::default(), DVec3::X, DVec3::Y), 4).size,
            4
        );
    }
}
