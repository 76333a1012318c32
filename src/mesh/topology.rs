//! Topology of a mesh: the triangles at each edge and vertex, and its defects.
//!
//! Half-edge 3 t + k is edge k of triangle t, from its corner k to its corner k + 1.

use super::TriMesh;
use crate::geom::triangle::TriangleSide;
use crate::geom::union_find::UnionFind;
use rayon::prelude::*;

/// Rings of triangles around edges and vertices.
#[derive(Clone, Debug, Default)]
pub struct Topology {
    /// Next half-edge of the same undirected edge for each half-edge, cyclically; itself on a
    /// border.
    next_around_edge: Vec<u32>,
    /// Triangles around vertex v: `vertex_triangles[vertex_start[v]..vertex_start[v + 1]]`,
    /// ascending.
    vertex_start: Vec<u32>,
    vertex_triangles: Vec<u32>,
    defects: Defects,
}

/// The defects that keep a mesh from being the boundary of a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Defects {
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Edges that their triangles do not run through equally often in both directions, boundary
    /// edges not counted.
    pub misoriented_edges: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// The first boundary edge, as a pair of vertex numbers.
    pub first_boundary: Option<[u32; 2]>,
    /// The first misoriented edge.
    pub first_misoriented: Option<[u32; 2]>,
}

impl Defects {
    /// Whether the mesh is closed and consistently oriented: the boundary of a solid.
    pub fn is_closed(&self) -> bool {
        self.boundary_edges == 0 && self.misoriented_edges == 0
    }
}

impl Topology {
    /// Returns the topology of `mesh`.
    pub fn new(mesh: &TriMesh) -> Self {
        let ((vertex_start, vertex_corners), half_edges) =
            rayon::join(|| corners_by_vertex(mesh), || half_edges_by_lower_vertex(mesh));
        let mut next_around_edge: Vec<u32> = (0..3 * mesh.triangles.len() as u32).collect();
        let mut defects = Defects::default();
        for group in half_edges.chunk_by(|a, b| a.ends == b.ends) {
            for (i, half_edge) in group.iter().enumerate() {
                next_around_edge[half_edge.number as usize] = group[(i + 1) % group.len()].number;
            }
            defects.add(group);
        }
        let vertex_triangles = vertex_corners.iter().map(|&c| c / 3).collect();
        Topology { next_around_edge, vertex_start, vertex_triangles, defects }
    }

    /// Returns the defects that keep the mesh from being closed.
    pub fn defects(&self) -> &Defects {
        &self.defects
    }

    /// Returns the triangles at edge `side` of `triangle`, each with the side it has there,
    /// starting with the triangle itself.
    pub fn around_edge(
        &self,
        triangle: u32,
        side: TriangleSide,
    ) -> impl Iterator<Item = (u32, TriangleSide)> + '_ {
        let start = 3 * triangle + side.index() as u32;
        std::iter::successors(Some(start), move |&h| {
            Some(self.next_around_edge[h as usize]).filter(|&next| next != start)
        })
        .map(|h| (h / 3, TriangleSide::ALL[(h % 3) as usize]))
    }

    /// Returns the triangles at `vertex`, ascending.
    pub fn around_vertex(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.vertex_triangles[self.vertex_start[v] as usize..self.vertex_start[v + 1] as usize]
    }

    /// Returns the number of connected components: sets of triangles joined by edges.
    pub fn components(&self) -> usize {
        let triangles = self.next_around_edge.len() / 3;
        let mut sets = UnionFind::new(triangles as u32);
        let mut components = triangles;
        for (h, &next) in (0..).zip(&self.next_around_edge) {
            components -= usize::from(sets.join(h / 3, next / 3));
        }
        components
    }

    /// Returns the number of undirected edges.
    pub fn edges(&self) -> usize {
        let first_of_its_ring = |h: u32| {
            let mut next = self.next_around_edge[h as usize];
            while next > h {
                next = self.next_around_edge[next as usize];
            }
            next == h
        };
        (0..self.next_around_edge.len() as u32).into_par_iter().filter(|&h| first_of_its_ring(h)).count()
    }
}

#[derive(Clone, Copy)]
struct HalfEdge {
    /// Vertex numbers, the lower one first.
    ends: [u32; 2],
    number: u32,
    ascending: bool,
}

impl Defects {
    fn add(&mut self, edge: &[HalfEdge]) {
        let ascending = edge.iter().filter(|h| h.ascending).count();
        if edge.len() == 1 {
            self.boundary_edges += 1;
            self.first_boundary.get_or_insert(edge[0].ends);
        } else if 2 * ascending != edge.len() {
            self.misoriented_edges += 1;
            self.first_misoriented.get_or_insert(edge[0].ends);
        }
        if edge.len() > 2 {
            self.non_manifold_edges += 1;
        }
    }
}

/// Corners (3 t + k) by the vertex they are at, as offsets and a flat list.
fn corners_by_vertex(mesh: &TriMesh) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; mesh.vertices.len() + 1];
    for &v in mesh.triangles.as_flattened() {
        start[v as usize + 1] += 1;
    }
    for v in 0..mesh.vertices.len() {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut corners = vec![0; 3 * mesh.triangles.len()];
    for (corner, &v) in mesh.triangles.as_flattened().iter().enumerate() {
        corners[next[v as usize] as usize] = corner as u32;
        next[v as usize] += 1;
    }
    (start, corners)
}

/// Returns all half-edges, sorted by their ends, then by number: a counting sort by the lower end,
/// then a sort of the few that share it.
fn half_edges_by_lower_vertex(mesh: &TriMesh) -> Vec<HalfEdge> {
    let half_edge = |number: usize| {
        let t = mesh.triangles[number / 3];
        let (a, b) = (t[number % 3], t[(number + 1) % 3]);
        HalfEdge { ends: [a.min(b), a.max(b)], number: number as u32, ascending: a < b }
    };
    let count = 3 * mesh.triangles.len();
    let mut start = vec![0u32; mesh.vertices.len() + 1];
    for number in 0..count {
        start[half_edge(number).ends[0] as usize + 1] += 1;
    }
    for v in 0..mesh.vertices.len() {
        start[v + 1] += start[v];
    }
    let mut next = start;
    let mut sorted = vec![HalfEdge { ends: [0; 2], number: 0, ascending: true }; count];
    for number in 0..count {
        let h = half_edge(number);
        let end = &mut next[h.ends[0] as usize];
        sorted[*end as usize] = h;
        *end += 1;
    }
    let mut groups: Vec<&mut [HalfEdge]> = sorted.chunk_by_mut(|a, b| a.ends[0] == b.ends[0]).collect();
    groups.par_iter_mut().with_min_len(1024).for_each(|g| g.sort_unstable_by_key(|h| (h.ends[1], h.number)));
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a tetrahedron on four vertices.
    fn tetrahedron() -> TriMesh {
        TriMesh {
            vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
        }
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let topology = Topology::new(&tetrahedron());
        assert!(topology.defects().is_closed());
        assert_eq!((topology.edges(), topology.components()), (6, 1));
        assert_eq!(topology.around_vertex(3), [1, 2, 3]);
        let around: Vec<u32> = topology.around_edge(0, TriangleSide::ALL[0]).map(|(t, _)| t).collect();
        assert_eq!(around, [0, 3]);
    }

    #[test]
    fn defects_are_counted_and_located() {
        let mut open = tetrahedron();
        open.triangles.pop();
        let defects = *Topology::new(&open).defects();
        assert_eq!((defects.boundary_edges, defects.misoriented_edges), (3, 0));
        assert_eq!(defects.first_boundary, Some([0, 2]));

        let mut twisted = tetrahedron();
        twisted.triangles[3].swap(0, 1);
        let defects = *Topology::new(&twisted).defects();
        assert_eq!((defects.boundary_edges, defects.misoriented_edges), (0, 3));
    }

    #[test]
    fn two_solids_touching_along_an_edge_are_closed() {
        let mut mesh = tetrahedron();
        mesh.vertices.extend([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
        // The second tetrahedron shares the edge 0-3.
        mesh.triangles.extend([[0, 5, 4], [0, 4, 3], [4, 5, 3], [5, 0, 3]]);
        let topology = Topology::new(&mesh);
        assert!(topology.defects().is_closed());
        assert_eq!(topology.defects().non_manifold_edges, 1);
        assert_eq!(topology.components(), 1);
    }
}
