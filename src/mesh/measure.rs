//! Area and volume of a mesh.

use super::TriMesh;
use glam::DVec3;

impl TriMesh {
    /// Returns the surface area, in square model units.
    ///
    /// # Panics
    /// When a vertex number is out of range.
    pub fn area(&self) -> f64 {
        area(self)
    }

    /// Returns the signed volume that the mesh encloses, in cubic model units: positive when the
    /// triangles are counter-clockwise seen from outside, negative when the mesh is inside out.
    ///
    /// It means something for a closed and consistently oriented mesh only. Parts inside one
    /// another add up with their signs, so a solid with a cavity has the volume of its material.
    ///
    /// # Panics
    /// When a vertex number is out of range.
    pub fn signed_volume(&self) -> f64 {
        signed_volume(self)
    }
}

/// Returns the surface area, in square model units.
///
/// # Panics
/// When a vertex number is out of range.
pub fn area(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(DVec3::from);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum()
}

/// Returns the signed volume enclosed by the mesh, in cubic model units. It is positive when the
/// triangles are counter-clockwise seen from outside, negative when the mesh is inside out.
///
/// Meaningful for a closed, consistently oriented mesh only. Parts that lie inside one another add
/// up with their signs, so a solid with a cavity has the volume of its material.
///
/// # Panics
/// When a vertex number is out of range.
pub fn signed_volume(mesh: &TriMesh) -> f64 {
    let Some([lo, hi]) = mesh.bounding_box() else { return 0.0 };
    // Tetrahedra are spanned from the centre of the box, not from the world origin: far from the
    // origin their volumes would be large numbers that cancel.
    let origin = 0.5 * (DVec3::from(lo) + DVec3::from(hi));
    (0..mesh.triangles.len())
        .map(|t| {
            let [a, b, c] = mesh.corners(t).map(|p| DVec3::from(p) - origin);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use std::f64::consts::PI;

    #[test]
    fn box_is_exact_and_translation_does_not_matter() {
        let mut mesh = shapes::cube(8);
        assert!((area(&mesh) - 24.0).abs() < 1e-12);
        assert!((signed_volume(&mesh) - 8.0).abs() < 1e-12);
        mesh.vertices.iter_mut().for_each(|v| v.iter_mut().for_each(|x| *x += 1e6));
        assert!((signed_volume(&mesh) - 8.0).abs() < 1e-7);
    }

    #[test]
    fn turned_inside_out_the_volume_is_negative() {
        let mut mesh = shapes::cube(4);
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!((signed_volume(&mesh) + 8.0).abs() < 1e-12);
    }

    #[test]
    fn sphere_converges_at_second_order() {
        let error = |detail| {
            let mesh = shapes::sphere(detail);
            (4.0 * PI / 3.0 - signed_volume(&mesh), 4.0 * PI - area(&mesh))
        };
        let (coarse, fine) = (error(8), error(16));
        assert!(fine.0 > 0.0 && fine.1 > 0.0, "an inscribed mesh is smaller than its sphere");
        assert!((coarse.0 / fine.0 - 4.0).abs() < 0.1, "volume: {coarse:?} {fine:?}");
        assert!((coarse.1 / fine.1 - 4.0).abs() < 0.1, "area: {coarse:?} {fine:?}");
    }

    #[test]
    fn empty_mesh_measures_nothing() {
        assert_eq!(area(&TriMesh::default()), 0.0);
        assert_eq!(signed_volume(&TriMesh::default()), 0.0);
    }
}
