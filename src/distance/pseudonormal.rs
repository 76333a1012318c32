//! Angle-weighted pseudonormals of faces, edges and vertices.
//!
//! With p outside every closed, consistently oriented surface and c its closest point,
//! (p - c) . pseudonormal(c) > 0; inside it is negative. For an edge the two triangles have the same
//! angle, so their normals are summed; for a vertex each triangle counts by its angle there.

use crate::geom::triangle::{Feature, Side, Triangle};
use crate::mesh::{Topology, TriMesh};
use crate::ssvh::Ssvh;
use glam::DVec3;
use rayon::prelude::*;

/// Angle-weighted sums per vertex; edges and faces follow from the triangles.
#[derive(Clone, Debug)]
pub(super) struct Pseudonormals {
    by_vertex: Vec<DVec3>,
}

impl Pseudonormals {
    pub(super) fn new(mesh: &TriMesh, topology: &Topology, triangles: &Ssvh) -> Self {
        let by_vertex = (0..mesh.vertices.len() as u32)
            .into_par_iter()
            .with_min_len(1024)
            .map(|v| {
                let around = topology.around_vertex(v).iter();
                around.map(|&t| angle_weighted(triangles.triangle(t), mesh.triangles[t as usize], v)).sum()
            })
            .collect();
        Pseudonormals { by_vertex }
    }

    /// The pseudonormal, not normalised, of a feature of triangle `id`.
    pub(super) fn of(
        &self,
        mesh: &TriMesh,
        topology: &Topology,
        triangles: &Ssvh,
        id: u32,
        feature: Feature,
    ) -> DVec3 {
        let vertex = |side: Side| self.by_vertex[mesh.triangles[id as usize][side.index()] as usize];
        match feature {
            Feature::Face => triangles.triangle(id).normal,
            Feature::Vertex(side) => vertex(side),
            Feature::Edge(side) => {
                let sum: DVec3 =
                    topology.around_edge(id, side).map(|(t, _)| triangles.triangle(t).normal).sum();
                // Needles on both sides have no normal; the ends of the edge know better.
                if sum == DVec3::ZERO { vertex(side) + vertex(side.next()) } else { sum }
            }
        }
    }
}

/// The normal of `triangle` times its angle at mesh vertex `v`.
fn angle_weighted(triangle: &Triangle, vertices: [u32; 3], v: u32) -> DVec3 {
    let Some(&side) = Side::ALL.iter().find(|s| vertices[s.index()] == v) else { return DVec3::ZERO };
    let corner = triangle.corners[side.index()];
    let to_next = triangle.corners[side.next().index()] - corner;
    let to_last = triangle.corners[side.next().next().index()] - corner;
    // The arc tangent keeps its digits at angles near 0 and pi, where the arc cosine loses them.
    let angle = to_next.cross(to_last).length().atan2(to_next.dot(to_last));
    triangle.normal * angle
}
