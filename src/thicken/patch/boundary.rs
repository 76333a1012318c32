//! The boundary of an open mesh: its loops, and the walls that stand on it
//! (\[WC13\] section 4.1).

use crate::distance::Sample;
use crate::geom::triangle::{Feature, TriangleSide};
use crate::mesh::{Topology, TriMesh};
use crate::thicken::PatchError;
use glam::DVec3;
use std::collections::BTreeMap;

/// The boundary of an oriented 2-manifold mesh.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    /// Vertex numbers of each loop, in the direction in which the triangles run through its edges.
    pub loops: Vec<Vec<u32>>,
    /// Per vertex, whether it is on the boundary.
    on_boundary: Vec<bool>,
    /// Per half-edge (3 t + side), whether it is on the boundary.
    edges: Vec<bool>,
    /// Per vertex of the boundary, the outward unit vector in the surface: the mean of its two
    /// edges'.
    outward: Vec<DVec3>,
    /// Vertices in which several fans of triangles touch, ascending.
    pub touching: Vec<u32>,
    /// Mean unit normal of all triangles at each touching vertex.
    touching_normals: Vec<DVec3>,
}

/// An edge with one triangle.
#[derive(Clone, Copy, Debug)]
struct BoundaryEdge {
    /// Both ends, in the direction of the triangle.
    ends: [u32; 2],
    triangle: u32,
    side: TriangleSide,
}

impl Boundary {
    /// Finds the boundary of `mesh`.
    ///
    /// # Errors
    /// - [`PatchError::NonManifoldEdge`]: an edge has more than two triangles.
    /// - [`PatchError::Misoriented`]: the two triangles of an edge run the same way.
    /// - [`PatchError::NonManifoldVertex`]: a vertex inside the surface is one of another part,
    ///   too.
    pub fn new(mesh: &TriMesh, topology: &Topology) -> Result<Boundary, PatchError> {
        let defects = topology.defects();
        let ends = |edge: [u32; 2]| edge.map(|v| mesh.vertices[v as usize]);
        let mut edges = vec![false; 3 * mesh.triangles.len()];
        let mut starts = Vec::with_capacity(defects.boundary_edges);
        for (t, triangle) in (0u32..).zip(&mesh.triangles) {
            for side in TriangleSide::ALL {
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
                starts.push(BoundaryEdge { ends: [a, b], triangle: t, side });
            }
        }
        let touching = touching_vertices(mesh, topology)?;
        let loops = trace(mesh, topology, &starts, &touching);
        let mut on_boundary = vec![false; mesh.vertices.len()];
        let mut outward = vec![DVec3::ZERO; mesh.vertices.len()];
        for &BoundaryEdge { ends, triangle, side } in &starts {
            let wall = outward_of(mesh.corners(triangle as usize).map(DVec3::from), side);
            for v in ends {
                on_boundary[v as usize] = true;
                outward[v as usize] += wall;
            }
        }
        outward.iter_mut().for_each(|v| *v = v.normalize_or_zero());
        let mean = |&v: &u32| {
            let around = topology.around_vertex(v).iter();
            around.map(|&t| unit_normal(mesh, t)).sum::<DVec3>().normalize_or_zero()
        };
        let touching_normals = touching.iter().map(mean).collect();
        Ok(Boundary { loops, on_boundary, edges, outward, touching, touching_normals })
    }

    /// Whether the mesh is closed.
    pub fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }

    /// Returns, per triangle of `mesh`, whether a vertex of it is on the boundary.
    pub fn triangles_at(&self, mesh: &TriMesh) -> Vec<bool> {
        mesh.triangles.iter().map(|t| t.iter().any(|&v| self.on_boundary[v as usize])).collect()
    }

    /// Whether a feature of a triangle of `mesh` is on the boundary.
    #[inline]
    pub fn holds(&self, mesh: &TriMesh, triangle: u32, feature: Feature) -> bool {
        match feature {
            Feature::Face => false,
            Feature::Edge(side) => self.edges[3 * triangle as usize + side.index()],
            Feature::Vertex(side) => {
                let vertex = mesh.triangles[triangle as usize][side.index()];
                self.on_boundary[vertex as usize]
            }
        }
    }

    /// Returns the unit normal at a vertex in which parts of the surface touch.
    pub fn touching_normal(&self, vertex: u32) -> DVec3 {
        self.touching.binary_search(&vertex).map_or(DVec3::ZERO, |n| self.touching_normals[n])
    }

    /// Returns the unit normal of the wall that stands on the boundary at a point of it. The normal
    /// lies in the plane of the surface and leads out of it.
    pub fn wall(&self, mesh: &TriMesh, sample: &Sample) -> DVec3 {
        let triangle = sample.triangle;
        match sample.feature {
            Feature::Edge(side) => outward_of(mesh.corners(triangle as usize).map(DVec3::from), side),
            Feature::Vertex(side) => self.outward[mesh.triangles[triangle as usize][side.index()] as usize],
            Feature::Face => DVec3::ZERO,
        }
    }
}

/// Returns the unit vector in the plane of a triangle that leads out of it across an edge.
fn outward_of(corners: [DVec3; 3], side: TriangleSide) -> DVec3 {
    let [a, b, c] = [side, side.next(), side.next().next()].map(|s| corners[s.index()]);
    let along = (b - a).normalize_or_zero();
    let inward = (c - a) - along * (c - a).dot(along);
    -inward.normalize_or_zero()
}

/// Returns the unit normal of a triangle.
fn unit_normal(mesh: &TriMesh, triangle: u32) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle as usize).map(DVec3::from);
    (b - a).cross(c - a).normalize_or_zero()
}

/// Finds the vertices with several fans of triangles.
///
/// # Errors
/// A vertex with a closed fan and another one: the surface around it leaves no room.
fn touching_vertices(mesh: &TriMesh, topology: &Topology) -> Result<Vec<u32>, PatchError> {
    let mut touching = Vec::new();
    for v in 0..mesh.vertices.len() as u32 {
        let around = topology.around_vertex(v);
        // An open fan has one edge on the boundary that starts at the vertex.
        let (mut seen, mut open, mut closed) = (0, 0, 0);
        let mut visited = vec![false; around.len()];
        while let Some(first) = visited.iter().position(|v| !v) {
            let (size, is_open) = fan(mesh, topology, v, around[first], |t| {
                let n = around.binary_search(&t).unwrap_or(first);
                !std::mem::replace(&mut visited[n], true)
            });
            seen += size;
            open += usize::from(is_open);
            closed += usize::from(!is_open);
        }
        debug_assert!(seen <= around.len(), "each triangle is in one fan");
        if closed > 1 || closed == 1 && open > 0 {
            return Err(PatchError::NonManifoldVertex { at: mesh.vertices[v as usize] });
        }
        if open > 1 {
            touching.push(v);
        }
    }
    Ok(touching)
}

/// Walks the triangles of a fan around `v` in both directions from `first`, as long as `visit` has
/// not seen them. Returns the number of triangles, and whether the fan is open.
fn fan(
    mesh: &TriMesh,
    topology: &Topology,
    v: u32,
    first: u32,
    mut visit: impl FnMut(u32) -> bool,
) -> (usize, bool) {
    let mut size = usize::from(visit(first));
    for forward in [true, false] {
        let mut at = first;
        loop {
            let corners = mesh.triangles[at as usize];
            let Some(corner) = TriangleSide::ALL.into_iter().find(|s| corners[s.index()] == v) else { break };
            let side = if forward { corner } else { corner.next().next() };
            let Some((other, _)) = topology.around_edge(at, side).nth(1) else { break };
            if !visit(other) {
                // All the way round.
                return (size, false);
            }
            size += 1;
            at = other;
        }
    }
    (size, true)
}

/// Joins boundary edges to loops.
///
/// Where fans touch in a vertex, a loop goes on with the next fan's edge across the gap. The strips
/// along the gaps then join the fans to one ring around the vertex, and the solid is 2-manifold
/// there.
fn trace(mesh: &TriMesh, topology: &Topology, starts: &[BoundaryEdge], touching: &[u32]) -> Vec<Vec<u32>> {
    // The edge that starts at each vertex with one fan.
    let mut from = vec![usize::MAX; mesh.vertices.len()];
    let mut fans: BTreeMap<u32, Vec<Fan>> = touching.iter().map(|&v| (v, Vec::new())).collect();
    for (n, edge) in starts.iter().enumerate() {
        let v = edge.ends[0];
        from[v as usize] = n;
        if let Some(fans) = fans.get_mut(&v) {
            let mut triangles = Vec::new();
            fan(mesh, topology, v, edge.triangle, |t| {
                let is_new = !triangles.contains(&t);
                triangles.push(t);
                is_new
            });
            fans.push(Fan { first: n, triangles });
        }
    }
    for (&v, fans) in &mut fans {
        sort_around(mesh, starts, v, fans);
    }
    let next = |edge: &BoundaryEdge| {
        let v = edge.ends[1];
        match fans.get(&v) {
            None => from[v as usize],
            Some(fans) => {
                let own = fans.iter().position(|fan| fan.triangles.contains(&edge.triangle));
                fans[(own.expect("a boundary edge is one of a fan") + 1) % fans.len()].first
            }
        }
    };
    let mut done = vec![false; starts.len()];
    let mut loops = Vec::new();
    for n in 0..starts.len() {
        let (mut at, mut around) = (n, Vec::new());
        // Each edge follows one: the walk comes back to where it began.
        while !std::mem::replace(&mut done[at], true) {
            around.push(starts[at].ends[0]);
            at = next(&starts[at]);
        }
        if !around.is_empty() {
            loops.push(around);
        }
    }
    loops
}

/// A fan: triangles around a vertex that are joined by edges.
struct Fan {
    /// The boundary edge that starts at the vertex.
    first: usize,
    triangles: Vec<u32>,
}

/// Sorts the fans at `v` counter-clockwise around their mean normal.
fn sort_around(mesh: &TriMesh, starts: &[BoundaryEdge], v: u32, fans: &mut [Fan]) {
    let at = DVec3::from(mesh.vertices[v as usize]);
    let normal: DVec3 = fans.iter().flat_map(|fan| &fan.triangles).map(|&t| unit_normal(mesh, t)).sum();
    let leads = |fan: &Fan| DVec3::from(mesh.vertices[starts[fan.first].ends[1] as usize]) - at;
    let zero = leads(&fans[0]);
    let angle = |fan: &Fan| {
        let to = leads(fan);
        let angle = normal.dot(zero.cross(to)).atan2(normal.length() * zero.dot(to));
        if angle < 0.0 { angle + std::f64::consts::TAU } else { angle }
    };
    // Angles are counted from the first fan, which stays the first.
    fans[1..].sort_by(|a, b| angle(a).total_cmp(&angle(b)));
}
