//! The signed distance dis(p): negative inside.

use super::pseudonormal::{Oriented, Pseudonormals};
use crate::geom::triangle::{ClosestPoint, Feature};
use crate::mesh::{Topology, TriMesh};
use crate::ssvh::Ssvh;
use glam::DVec3;

/// A mesh prepared for signed distance queries.
#[derive(Debug)]
pub struct SignedDistance<'m> {
    mesh: &'m TriMesh,
    topology: &'m Topology,
    ssvh: Ssvh,
    pseudonormals: Pseudonormals,
}

/// The signed distance at a point, and where the closest point lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Signed distance in model units, negative inside; +0 on the surface.
    pub distance: f64,
    /// Mesh number of the closest triangle (the lowest one of several).
    pub triangle: u32,
    /// The closest point.
    pub closest: DVec3,
    /// The feature of the triangle that the closest point is on.
    pub feature: Feature,
}

impl<'m> SignedDistance<'m> {
    /// Builds the hierarchy on the current rayon pool.
    ///
    /// # Panics
    /// When the mesh has no triangles.
    pub fn new(mesh: &'m TriMesh, topology: &'m Topology) -> Self {
        let ssvh = Ssvh::new(mesh);
        let pseudonormals = Pseudonormals::new(mesh);
        SignedDistance { mesh, topology, ssvh, pseudonormals }
    }

    /// Returns the mesh.
    pub fn mesh(&self) -> &'m TriMesh {
        self.mesh
    }

    /// Returns the mesh's topology.
    pub fn topology(&self) -> &'m Topology {
        self.topology
    }

    /// Returns the hierarchy over the mesh's triangles.
    pub fn ssvh(&self) -> &Ssvh {
        &self.ssvh
    }

    /// Returns the signed distance at `p`; `guess` is a triangle that may be near, for speed only.
    pub fn at(&self, p: DVec3, guess: u32) -> Sample {
        self.from_triangle(p, self.ssvh.closest_from(p, guess).triangle)
    }

    /// Returns the signed distance at `p` when `triangle` is known to be the closest.
    pub fn from_triangle(&self, p: DVec3, triangle: u32) -> Sample {
        let ClosestPoint { point, distance_squared, feature } = self.ssvh.triangle(triangle).closest(p);
        let side = (p - point).dot(self.pseudonormal(triangle, feature));
        let distance = distance_squared.sqrt();
        let distance = if side < 0.0 { -distance } else { distance };
        Sample { distance, triangle, closest: point, feature }
    }

    /// Returns the angle-weighted pseudonormal of a feature, not normalised; points outward.
    pub fn pseudonormal(&self, triangle: u32, feature: Feature) -> DVec3 {
        let oriented = Oriented { mesh: self.mesh, topology: self.topology, triangles: &self.ssvh };
        self.pseudonormals.of(oriented, triangle, feature)
    }

    /// Returns the unit gradient of the distance at `p`, where `sample` was taken: the normal of
    /// the offset surface through `p`, outward. On the surface itself, where the direction to the
    /// closest point vanishes (nearer than `vanishing`), the pseudonormal takes its place.
    pub fn gradient(&self, p: DVec3, sample: &Sample, vanishing: f64) -> DVec3 {
        if sample.feature != Feature::Face && sample.distance.abs() > vanishing {
            return (p - sample.closest) / sample.distance;
        }
        let normal = self.pseudonormal(sample.triangle, sample.feature);
        normal.try_normalize().unwrap_or(DVec3::Z)
    }
}
