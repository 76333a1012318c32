//! The necessary condition for the analytic solution (\[LW11\] Remark 4): the closest points of
//! both ends lie on one triangle.
//!
//! A closest point on an edge or a vertex belongs to every triangle there, so the two triangles
//! that the queries name may differ although a common one exists. The paper lists five such
//! configurations, with their mirror images: face and edge, face and vertex, edge and edge, edge
//! and vertex, vertex and vertex.

use crate::distance::{Sample, SignedDistance};
use crate::geom::triangle::Feature;

/// The feature that a closest point lies on, by what identifies it in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MeshFeature {
    Face(u32),
    Edge([u32; 2]),
    Vertex(u32),
}

/// Returns the triangle with the lowest number that holds the closest points of both samples.
pub(super) fn shared_triangle(distance: &SignedDistance, a: &Sample, b: &Sample) -> Option<u32> {
    if a.triangle == b.triangle {
        return Some(a.triangle);
    }
    use MeshFeature::{Edge, Face, Vertex};
    let (fa, fb) = (mesh_feature(distance, a), mesh_feature(distance, b));
    match (fa, fb) {
        // Two different faces share no interior point.
        (Face(_), Face(_)) => None,
        // Face and edge, face and vertex: the face itself, if it has that edge or vertex.
        (Face(t), other) | (other, Face(t)) => touches(distance, t, other).then_some(t),
        // Edge and edge, edge and vertex: the few triangles at the edge.
        (Edge(_), other) => at_edge(distance, a, other),
        (other, Edge(_)) => at_edge(distance, b, other),
        // Vertex and vertex: the triangles at one of them.
        (Vertex(v), other) => {
            distance.topology().around_vertex(v).iter().copied().find(|&t| touches(distance, t, other))
        }
    }
}

fn mesh_feature(distance: &SignedDistance, sample: &Sample) -> MeshFeature {
    let vertices = distance.mesh().triangles[sample.triangle as usize];
    match sample.feature {
        Feature::Face => MeshFeature::Face(sample.triangle),
        Feature::Edge(side) => MeshFeature::Edge([vertices[side.index()], vertices[side.next().index()]]),
        Feature::Vertex(side) => MeshFeature::Vertex(vertices[side.index()]),
    }
}

/// Returns the lowest triangle at the edge that `sample` lies on which touches `other`.
fn at_edge(distance: &SignedDistance, sample: &Sample, other: MeshFeature) -> Option<u32> {
    let Feature::Edge(side) = sample.feature else { unreachable!("the sample lies on an edge") };
    let around = distance.topology().around_edge(sample.triangle, side).map(|(t, _)| t);
    around.filter(|&t| touches(distance, t, other)).min()
}

/// Whether `feature` is a part of triangle `t`.
fn touches(distance: &SignedDistance, t: u32, feature: MeshFeature) -> bool {
    let vertices = &distance.mesh().triangles[t as usize];
    match feature {
        MeshFeature::Face(face) => face == t,
        MeshFeature::Edge([v, w]) => vertices.contains(&v) && vertices.contains(&w),
        MeshFeature::Vertex(v) => vertices.contains(&v),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::triangle::TriangleSide;
    use crate::mesh::{Topology, TriMesh};
    use glam::DVec3;

    /// Returns a fan of four triangles around vertex 0 and two more beyond, in the plane.
    fn mesh() -> TriMesh {
        let v = |x: f64, y: f64| [x, y, 0.0];
        TriMesh {
            vertices: vec![v(0., 0.), v(1., 0.), v(0., 1.), v(-1., 0.), v(0., -1.), v(2., 2.), v(-2., 2.)],
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [1, 5, 2], [2, 6, 3]],
        }
    }

    fn shared(a: (u32, Feature), b: (u32, Feature)) -> Option<u32> {
        let mesh = mesh();
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        let sample = |(triangle, feature)| Sample { distance: 1.0, triangle, closest: DVec3::ZERO, feature };
        let (a, b) = (sample(a), sample(b));
        let forward = shared_triangle(&distance, &a, &b);
        assert_eq!(forward, shared_triangle(&distance, &b, &a), "the mirror image");
        forward
    }

    const FACE: Feature = Feature::Face;

    fn edge(k: usize) -> Feature {
        Feature::Edge(TriangleSide::ALL[k])
    }

    fn vertex(k: usize) -> Feature {
        Feature::Vertex(TriangleSide::ALL[k])
    }

    #[test]
    fn face_and_face() {
        assert_eq!(shared((1, FACE), (1, FACE)), Some(1));
        assert_eq!(shared((0, FACE), (1, FACE)), None);
    }

    #[test]
    fn face_and_edge() {
        // Edge 0-2 named by triangle 1 is an edge of triangle 0 as well.
        assert_eq!(shared((0, FACE), (1, edge(0))), Some(0));
        assert_eq!(shared((3, FACE), (1, edge(0))), None);
    }

    #[test]
    fn face_and_vertex() {
        // Vertex 2 named by triangle 5.
        assert_eq!(shared((0, FACE), (5, vertex(0))), Some(0));
        assert_eq!(shared((2, FACE), (5, vertex(0))), None);
    }

    #[test]
    fn edge_and_edge() {
        // Edge 1-2 named by triangle 4 and edge 0-2 named by triangle 1 are both edges of
        // triangle 0.
        assert_eq!(shared((4, edge(2)), (1, edge(0))), Some(0));
        // Edge 1-5 and edge 0-2: no triangle has both.
        assert_eq!(shared((4, edge(0)), (1, edge(0))), None);
        // One edge, named by either triangle: the lower number.
        assert_eq!(shared((0, edge(2)), (1, edge(0))), Some(0));
    }

    #[test]
    fn edge_and_vertex() {
        // Edge 0-2 named by triangle 1; vertex 1 named by triangle 3.
        assert_eq!(shared((1, edge(0)), (3, vertex(2))), Some(0));
        assert_eq!(shared((1, edge(0)), (2, vertex(2))), None);
    }

    #[test]
    fn vertex_and_vertex() {
        // Vertices 1 (named by 4) and 3 (named by 5): no common triangle; 1 (by 4) and 4 (by 2):
        // triangle 3.
        assert_eq!(shared((4, vertex(0)), (5, vertex(2))), None);
        assert_eq!(shared((4, vertex(0)), (2, vertex(2))), Some(3));
    }
}
