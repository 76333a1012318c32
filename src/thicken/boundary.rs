//! The boundary curve of an open mesh: its loops, and the walls that stand on it.

use super::PatchError;
use crate::distance::Sample;
use crate::geom::triangle::{Feature, Side};
use crate::mesh::{Topology, TriMesh};
use glam::DVec3;

/// The boundary of an oriented 2-manifold mesh.
#[derive(Clone, Debug)]
pub(super) struct Boundary {
    /// Vertex numbers of each loop, in the direction in which the triangles run through its edges.
    pub loops: Vec<Vec<u32>>,
    /// Per vertex its place on the boundary, or [`NOWHERE`].
    places: Vec<LoopPlace>,
    /// Per half-edge (3 t + side) whether it is on the boundary.
    edges: Vec<bool>,
    /// Per vertex of the boundary the outward unit vector in the surface: the mean of its two edges'.
    outward: Vec<DVec3>,
}

/// Where a boundary vertex is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LoopPlace {
    /// The loop's number.
    pub number: u32,
    /// The vertex's position in it.
    pub position: u32,
}

const NOWHERE: LoopPlace = LoopPlace { number: u32::MAX, position: u32::MAX };

impl Boundary {
    /// The boundary of `mesh`.
    ///
    /// # Errors
    /// When an edge has more than two triangles or two that run the same way, or a vertex more than one fan.
    pub fn new(mesh: &TriMesh, topology: &Topology) -> Result<Boundary, PatchError> {
        let defects = topology.defects();
        let ends = |edge: [u32; 2]| edge.map(|v| mesh.vertices[v as usize]);
        let mut edges = vec![false; 3 * mesh.triangles.len()];
        // The boundary edge that starts at each vertex.
        let mut next = vec![u32::MAX; mesh.vertices.len()];
        let mut starts = Vec::with_capacity(defects.boundary_edges);
        for (t, triangle) in (0u32..).zip(&mesh.triangles) {
            for side in Side::ALL {
                let [a, b] = [triangle[side.index()], triangle[side.next().index()]];
                let mut ring = topology.around_edge(t, side).skip(1);
                let (other, more) = (ring.next(), ring.next());
                if more.is_some() {
                    return Err(PatchError::NonManifoldEdge { ends: ends([a, b]) });
                }
                if let Some((u, k)) = other {
                    if mesh.triangles[u as usize][k.index()] == a {
                        return Err(PatchError::Misoriented { ends: ends([a, b]) });
                    }
                    continue;
                }
                edges[3 * t as usize + side.index()] = true;
                if next[a as usize] != u32::MAX {
                    return Err(PatchError::NonManifoldVertex { at: mesh.vertices[a as usize] });
                }
                next[a as usize] = b;
                starts.push((a, t, side));
            }
        }
        check_fans(mesh, topology)?;
        let mut places = vec![NOWHERE; mesh.vertices.len()];
        let mut loops: Vec<Vec<u32>> = Vec::new();
        for &(start, ..) in &starts {
            if places[start as usize] != NOWHERE {
                continue;
            }
            let (mut around, mut at) = (Vec::new(), start);
            while places[at as usize] == NOWHERE {
                places[at as usize] = LoopPlace { number: loops.len() as u32, position: around.len() as u32 };
                around.push(at);
                // Each vertex has one edge in and one out: the walk comes back to where it began.
                at = next[at as usize];
            }
            loops.push(around);
        }
        let mut outward = vec![DVec3::ZERO; mesh.vertices.len()];
        for &(a, t, side) in &starts {
            let corners = mesh.corners(t as usize).map(DVec3::from);
            let wall = outward_of(corners, side);
            for v in [a, next[a as usize]] {
                outward[v as usize] += wall;
            }
        }
        outward.iter_mut().for_each(|v| *v = v.normalize_or_zero());
        Ok(Boundary { loops, places, edges, outward })
    }

    /// Whether the mesh is closed.
    pub fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }

    /// Whether a feature of a triangle of `mesh` is on the boundary.
    #[inline]
    pub fn holds(&self, mesh: &TriMesh, triangle: u32, feature: Feature) -> bool {
        match feature {
            Feature::Face => false,
            Feature::Edge(side) => self.edges[3 * triangle as usize + side.index()],
            Feature::Vertex(side) => {
                let vertex = mesh.triangles[triangle as usize][side.index()];
                self.places[vertex as usize] != NOWHERE
            }
        }
    }

    /// Where a vertex is on the boundary.
    pub fn place(&self, vertex: u32) -> Option<LoopPlace> {
        Some(self.places[vertex as usize]).filter(|place| *place != NOWHERE)
    }

    /// The normal of the wall that stands on the boundary at a point of it: out of the surface, within it.
    pub fn wall(&self, mesh: &TriMesh, sample: &Sample) -> DVec3 {
        let triangle = sample.triangle;
        match sample.feature {
            Feature::Edge(side) => outward_of(mesh.corners(triangle as usize).map(DVec3::from), side),
            Feature::Vertex(side) => self.outward[mesh.triangles[triangle as usize][side.index()] as usize],
            Feature::Face => DVec3::ZERO,
        }
    }
}

/// The unit vector in the plane of a triangle that leads out of it across an edge.
fn outward_of(corners: [DVec3; 3], side: Side) -> DVec3 {
    let [a, b, c] = [side, side.next(), side.next().next()].map(|s| corners[s.index()]);
    let along = (b - a).normalize_or_zero();
    let inward = (c - a) - along * (c - a).dot(along);
    -inward.normalize_or_zero()
}

/// Checks that the triangles at each vertex are one fan.
fn check_fans(mesh: &TriMesh, topology: &Topology) -> Result<(), PatchError> {
    for v in 0..mesh.vertices.len() as u32 {
        let around = topology.around_vertex(v);
        let Some(&first) = around.first() else { continue };
        // Walk the fan in both directions from the first triangle.
        let mut seen = 1;
        for forward in [true, false] {
            let mut at = first;
            loop {
                let corners = mesh.triangles[at as usize];
                let Some(corner) = Side::ALL.into_iter().find(|s| corners[s.index()] == v) else { break };
                let side = if forward { corner } else { corner.next().next() };
                let Some((other, _)) = topology.around_edge(at, side).nth(1) else { break };
                if other == first {
                    // All the way round: the other direction has nothing more.
                    return_if_incomplete(mesh, v, seen, around.len())?;
                    seen = usize::MAX;
                    break;
                }
                at = other;
                seen += 1;
                if seen > around.len() {
                    break;
                }
            }
            if seen == usize::MAX {
                break;
            }
        }
        if seen != usize::MAX {
            return_if_incomplete(mesh, v, seen, around.len())?;
        }
    }
    Ok(())
}

fn return_if_incomplete(mesh: &TriMesh, v: u32, seen: usize, all: usize) -> Result<(), PatchError> {
    if seen == all { Ok(()) } else { Err(PatchError::NonManifoldVertex { at: mesh.vertices[v as usize] }) }
}
