//! Edges of INPUT about which the true offset surface is round or sharp.

use crate::geom::triangle::TriangleSide;
use crate::mesh::{Topology, TriMesh};
use crate::ssvh::Ssvh;
use glam::DVec3;

/// Angle between normals, in radians, below which an edge is flat: the direction of its bend is
/// rounding.
const FLAT: f64 = 1e-6;

/// The way in which an edge bends the offset surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bend {
    /// The offset is an arc about the edge: convex when growing, concave when shrinking.
    Round,
    /// The offset has a crease: concave when growing, convex when shrinking.
    Sharp,
}

/// An edge with two triangles that do not lie in one plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct BentEdge {
    /// Both ends of the edge.
    pub ends: [DVec3; 2],
    /// Vertex numbers of the ends.
    pub vertices: [u32; 2],
    /// Unit normals of the edge's triangles.
    pub normals: [DVec3; 2],
    /// Angle between the normals, in radians.
    pub angle: f64,
    /// One of the edge's triangles.
    pub triangle: u32,
}

impl BentEdge {
    /// Returns the length of the edge, in model units.
    pub fn length(&self) -> f64 {
        (self.ends[1] - self.ends[0]).length()
    }

    /// Returns the point at parameter `t`, from 0 to 1.
    pub fn at(&self, t: f64) -> DVec3 {
        self.ends[0] + t * (self.ends[1] - self.ends[0])
    }
}

/// Finds all edges that bend the offset at distance `r` the given way. Edges with other than two
/// triangles, or with triangles that run the same way, bound no solid and are left out.
pub(super) fn bent_edges(
    mesh: &TriMesh,
    topology: &Topology,
    triangles: &Ssvh,
    r: f64,
    bend: Bend,
) -> Vec<BentEdge> {
    let mut found = Vec::new();
    for t in 0..mesh.triangles.len() as u32 {
        for side in TriangleSide::ALL {
            let mut ring = topology.around_edge(t, side).skip(1);
            let (Some((u, other)), None) = (ring.next(), ring.next()) else { continue };
            if u < t {
                continue;
            }
            let corner = |t: u32, side: TriangleSide| mesh.triangles[t as usize][side.index()];
            let vertices = [corner(t, side), corner(t, side.next())];
            if corner(u, other) != vertices[1] {
                continue;
            }
            let normals = [triangles.triangle(t).normal, triangles.triangle(u).normal];
            if normals.contains(&DVec3::ZERO) {
                continue;
            }
            let ends = vertices.map(|v| DVec3::from(mesh.vertices[v as usize]));
            let turn = normals[0].cross(normals[1]);
            let angle = turn.length().atan2(normals[0].dot(normals[1]));
            // On a convex edge the normal turns about the edge's direction in its first triangle.
            let convex = turn.dot(ends[1] - ends[0]) > 0.0;
            let round = convex == (r > 0.0);
            if angle > FLAT && round == (bend == Bend::Round) {
                found.push(BentEdge { ends, vertices, normals, angle, triangle: t });
            }
        }
    }
    found
}
