//! Planes near a polygon, as a quick lower bound of a point's distance from the surface.

use super::tangent_planes::MAX_PLANES;
use crate::contour::implicit_surface::{Creases, ImplicitSurface};
use glam::DVec3;

/// The bound of a surface's curvature, and the side to which its faces curve.
#[derive(Clone, Copy, Debug)]
pub struct CurvatureBound {
    creases: Creases,
    /// The bound, in one over model units.
    curvature: f64,
}

impl CurvatureBound {
    /// The bound for an unknown surface.
    pub const UNKNOWN: CurvatureBound = CurvatureBound { creases: Creases::Both, curvature: 0.0 };

    /// Returns the bound for a surface.
    pub fn of(surface: &dyn ImplicitSurface) -> CurvatureBound {
        CurvatureBound { creases: surface.creases(), curvature: surface.curvature() }
    }
}

/// The most planes: those of four features.
const MAX_CREASE_PLANES: usize = 4 * MAX_PLANES;

/// The planes of the features near a polygon, whose lowest or highest envelope is the surface
/// there, but for its curvature.
#[derive(Clone, Copy, Debug)]
pub struct CreasePlanes {
    /// Points with unit normals.
    planes: [(DVec3, DVec3); MAX_CREASE_PLANES],
    len: usize,
    bound: CurvatureBound,
}

impl CreasePlanes {
    /// No planes.
    pub const NONE: CreasePlanes = CreasePlanes::new(CurvatureBound::UNKNOWN);

    /// Makes a set without planes.
    pub const fn new(bound: CurvatureBound) -> CreasePlanes {
        CreasePlanes { planes: [(DVec3::ZERO, DVec3::ZERO); MAX_CREASE_PLANES], len: 0, bound }
    }

    /// Adds a plane, if there is room.
    pub fn push(&mut self, point: DVec3, normal: DVec3) {
        if self.len < MAX_CREASE_PLANES {
            self.planes[self.len] = (point, normal);
            self.len += 1;
        }
    }

    /// Whether there is no plane.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the least distance that `p` can have from the surface, in model units, however much
    /// the faces are curved.
    pub fn distance(&self, p: [f64; 3]) -> f64 {
        let p = DVec3::from(p);
        let CurvatureBound { creases, curvature } = self.bound;
        // Each plane gives a range of heights. These are the least and the largest of the lower
        // ends, and of the upper ends.
        let (mut least, mut largest) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (at, normal) in &self.planes[..self.len] {
            let offset = p - *at;
            let height = normal.dot(offset);
            let sag = 0.5 * curvature * offset.length_squared();
            let ends = match creases {
                Creases::Concave => [height, height + sag],
                Creases::Convex => [height - sag, height],
                Creases::Both => [height; 2],
            };
            for i in 0..2 {
                least[i] = least[i].min(ends[i]);
                largest[i] = largest[i].max(ends[i]);
            }
        }
        let from_zero = |[low, high]: [f64; 2]| low.max(-high).max(0.0);
        match creases {
            Creases::Concave => from_zero(least),
            Creases::Convex => from_zero(largest),
            Creases::Both => from_zero(least).min(from_zero(largest)),
        }
    }
}
