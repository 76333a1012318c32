//! The surface sampled in the coordinates of a cell.

use super::tangent_planes::TangentPlane;
use crate::contour::implicit_surface::ImplicitSurface;
use glam::DVec3;

/// Samples the surface in voxels from an origin, such as the lowest corner of a cell.
pub struct SurfaceProbe<'a> {
    /// The surface.
    pub surface: &'a dyn ImplicitSurface,
    /// The origin, in model units.
    pub origin: DVec3,
    /// The voxel size, in model units.
    pub voxel: f64,
    /// A triangle near the origin at first, then the closest one of the last sample.
    pub triangle: u32,
}

impl SurfaceProbe<'_> {
    /// Returns the signed distance in voxels and its unit gradient at `local`.
    pub fn sample(&mut self, local: DVec3) -> (f64, DVec3) {
        let sample = self.surface.sample(self.world(local), self.triangle);
        self.triangle = sample.triangle;
        (sample.distance / self.voxel, sample.gradient)
    }

    /// Returns the tangent plane at the point that `local` reaches along the gradient.
    pub fn tangent_plane(&mut self, local: DVec3) -> TangentPlane {
        let (distance, normal) = self.sample(local);
        TangentPlane { anchor: local + -distance * normal, normal, triangle: self.triangle }
    }

    /// Returns the tangent plane of the surface of one triangle at the point that `local` reaches
    /// along the gradient.
    pub fn tangent_plane_of(&self, triangle: u32, local: DVec3) -> TangentPlane {
        let sample = self.surface.sample_triangle(self.world(local), triangle);
        let normal = sample.gradient;
        TangentPlane { anchor: local + -sample.distance / self.voxel * normal, normal, triangle }
    }

    fn world(&self, local: DVec3) -> DVec3 {
        self.origin + self.voxel * local
    }
}
