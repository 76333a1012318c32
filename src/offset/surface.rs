//! The offset surface as the contour asks for it.

use crate::candidates::CandidateLists;
use crate::contour::{Creases, ImplicitSurface, SurfaceSample};
use crate::distance::SignedDistance;
use glam::DVec3;

/// All points at signed distance `r` from a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffsetSurface<'a> {
    pub distance: &'a SignedDistance<'a>,
    /// Signed distance in model units.
    pub r: f64,
    /// The triangles near the surface.
    pub lists: Option<&'a CandidateLists>,
    /// Distances from the mesh up to this, in model units, give no direction.
    pub vanishing: f64,
}

impl ImplicitSurface for OffsetSurface<'_> {
    fn creases(&self) -> Creases {
        // Growing takes the union of what grows around each part, shrinking the intersection.
        match self.r {
            r if r > 0.0 => Creases::Concave,
            r if r < 0.0 => Creases::Convex,
            _ => Creases::Both,
        }
    }

    fn curvature(&self) -> f64 {
        // Cylinders around edges and spheres around vertices; a triangle mesh itself is flat.
        if self.r == 0.0 { 0.0 } else { 1.0 / self.r.abs() }
    }

    fn sample(&self, p: DVec3, hint: u32) -> SurfaceSample {
        let near = self.lists.and_then(|lists| lists.at(p.to_array()));
        let sample = match near {
            Some(near) => {
                let hit = near.closest(self.distance.ssvh(), p);
                self.distance.from_triangle(p, hit.triangle)
            }
            None => self.distance.at(p, hint),
        };
        let gradient = self.distance.gradient(p, &sample, self.vanishing);
        SurfaceSample { distance: sample.distance - self.r, gradient, triangle: sample.triangle }
    }

    fn sample_triangle(&self, p: DVec3, triangle: u32) -> SurfaceSample {
        let shape = self.distance.ssvh().triangle(triangle);
        let from = p - shape.closest(p).point;
        let length = from.length();
        if self.r == 0.0 || length <= self.vanishing {
            // The surface is the triangle itself, continued as its plane.
            let height = (p - shape.corners[0]).dot(shape.normal);
            return SurfaceSample { distance: height - self.r, gradient: shape.normal, triangle };
        }
        // On the side of the triangle that is looked at: which one that is depends on the
        // neighbours only at r = 0.
        let outward = from / length.copysign(self.r);
        SurfaceSample { distance: length.copysign(self.r) - self.r, gradient: outward, triangle }
    }
}
