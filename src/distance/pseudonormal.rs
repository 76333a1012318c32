//! Angle-weighted pseudonormals of faces, edges and vertices.
//!
//! With p outside every closed, consistently oriented surface and c its closest point, (p - c) .
//! pseudonormal(c) > 0; inside it is negative. For an edge the two triangles have the same angle,
//! so their normals are summed; for a vertex each triangle counts by its angle there.

use crate::geom::triangle::{Feature, Triangle, TriangleSide};
use crate::mesh::{Topology, TriMesh};
use crate::ssvh::Ssvh;
use glam::DVec3;
use std::sync::atomic::{AtomicU64, Ordering};

/// Angle-weighted sums per vertex; edges and faces follow from the triangles.
///
/// The sum of a vertex is made when it is first asked for; most vertices of a mesh whose triangles
/// are small beside the voxels never are. Threads that ask at the same time compute the same
/// numbers, so it does not matter whose stay.
#[derive(Debug)]
pub(super) struct Pseudonormals {
    /// The bits of each coordinate, plus one; 0 as long as the sum is not known. No sum is the one
    /// NaN whose bits are all set.
    by_vertex: Vec<[AtomicU64; 3]>,
}

/// The mesh that the pseudonormals belong to, with its topology and hierarchy.
#[derive(Clone, Copy)]
pub(super) struct Oriented<'a> {
    pub(super) mesh: &'a TriMesh,
    pub(super) topology: &'a Topology,
    pub(super) triangles: &'a Ssvh,
}

impl Pseudonormals {
    pub(super) fn new(mesh: &TriMesh) -> Self {
        Pseudonormals { by_vertex: bytemuck::zeroed_vec(mesh.vertices.len()) }
    }

    /// Returns the pseudonormal, not normalised, of a feature of triangle `id`. `oriented` is
    /// always the same mesh.
    pub(super) fn of(&self, oriented: Oriented<'_>, id: u32, feature: Feature) -> DVec3 {
        let Oriented { mesh, topology, triangles } = oriented;
        let vertex = |side: TriangleSide| self.at_vertex(oriented, mesh.triangles[id as usize][side.index()]);
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

    fn at_vertex(&self, oriented: Oriented<'_>, v: u32) -> DVec3 {
        let stored = &self.by_vertex[v as usize];
        let known = stored.each_ref().map(|x| x.load(Ordering::Relaxed));
        if known.iter().all(|&x| x != 0) {
            return DVec3::from(known.map(|x| f64::from_bits(x - 1)));
        }
        let Oriented { mesh, topology, triangles } = oriented;
        let around = topology.around_vertex(v).iter();
        let sum: DVec3 =
            around.map(|&t| angle_weighted(triangles.triangle(t), mesh.triangles[t as usize], v)).sum();
        for (stored, x) in stored.iter().zip(sum.to_array()) {
            stored.store(x.to_bits().wrapping_add(1), Ordering::Relaxed);
        }
        sum
    }
}

/// Returns the normal of `triangle` times its angle at mesh vertex `v`.
fn angle_weighted(triangle: &Triangle, vertices: [u32; 3], v: u32) -> DVec3 {
    let Some(&side) = TriangleSide::ALL.iter().find(|s| vertices[s.index()] == v) else { return DVec3::ZERO };
    let corner = triangle.corners[side.index()];
    let to_next = triangle.corners[side.next().index()] - corner;
    let to_last = triangle.corners[side.next().next().index()] - corner;
    // The arc tangent keeps its digits at angles near 0 and pi, where the arc cosine loses them.
    let angle = to_next.cross(to_last).length().atan2(to_next.dot(to_last));
    triangle.normal * angle
}
