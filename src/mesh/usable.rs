//! Checks of a mesh: vertex numbers and coordinates that can be worked with.

use super::TriMesh;
use std::ops::RangeInclusive;

/// The lengths that can be worked with, in model units.
///
/// Bounds of distances are squared in 32 bits, which hold numbers from 1e-38 to 3e38. Within this
/// range results do not depend on the unit of length; beyond it bounds are lost.
pub const LENGTHS: RangeInclusive<f64> = 1e-18..=1e18;

/// A reason why a mesh cannot be worked with.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, and there are {vertices}")]
    NoVertex {
        /// The number of the triangle.
        triangle: usize,
        /// The number of the vertex.
        vertex: u32,
        /// The number of vertices.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// A coordinate is too large.
    #[error("vertex {vertex} has a coordinate of size {size:e}, and {:e} is the most; choose a larger unit of length", LENGTHS.end())]
    TooLarge {
        /// The number of the vertex.
        vertex: usize,
        /// The size of its largest coordinate.
        size: f64,
    },
    /// The mesh is too small.
    #[error("the mesh is {size:e} long, and {:e} is the least; choose a smaller unit of length", LENGTHS.start())]
    TooSmall {
        /// The longest side of its bounding box.
        size: f64,
    },
}

impl TriMesh {
    /// Checks that triangles name vertices that are there, and that the coordinates of all vertices
    /// can be worked with.
    ///
    /// # Errors
    /// The first triangle or vertex that is wrong.
    pub fn check(&self) -> Result<(), MeshError> {
        let vertices = self.vertices.len();
        for (triangle, corners) in self.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(MeshError::NoVertex { triangle, vertex, vertices });
            }
        }
        for (vertex, p) in self.vertices.iter().enumerate() {
            if p.iter().any(|x| !x.is_finite()) {
                return Err(MeshError::NotFinite(vertex));
            }
            let size = p.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            if size > *LENGTHS.end() {
                return Err(MeshError::TooLarge { vertex, size });
            }
        }
        if let Some([lo, hi]) = self.bounding_box() {
            let size = (0..3).map(|a| hi[a] - lo[a]).fold(0.0, f64::max);
            if size < *LENGTHS.start() && !self.triangles.is_empty() {
                return Err(MeshError::TooSmall { size });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn meshes_that_cannot_be_worked_with_are_told_why() {
        let scaled = |scale: f64| {
            let mut mesh = shapes::cube(1);
            mesh.vertices.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
            mesh
        };
        for fine in [1.0, 1e-17, 1e17] {
            assert_eq!(scaled(fine).check(), Ok(()));
        }
        assert!(matches!(scaled(1e20).check(), Err(MeshError::TooLarge { vertex: 0, .. })));
        assert!(matches!(scaled(1e-20).check(), Err(MeshError::TooSmall { .. })));
        let mut mesh = shapes::cube(1);
        let vertices = mesh.vertices.len();
        mesh.triangles[5][1] = vertices as u32;
        assert_eq!(mesh.check(), Err(MeshError::NoVertex { triangle: 5, vertex: vertices as u32, vertices }));
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut mesh = shapes::cube(1);
            mesh.vertices[3][2] = wrong;
            assert_eq!(mesh.check(), Err(MeshError::NotFinite(3)));
        }
    }
}
