//! Pairs of triangles made by hand, and the topology of the smallest meshes.

use super::audit;
use crate::mesh::TriMesh;
use crate::verify::Soundness;

fn audit(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Soundness {
    audit::audit(&TriMesh { vertices: vertices.to_vec(), triangles: triangles.to_vec() })
}

const BASE: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

/// The number of intersections of the base triangle with another one that shares its first
/// vertices.
fn against_base(shared: usize, others: &[[f64; 3]]) -> u64 {
    let mut vertices = BASE.to_vec();
    vertices.extend(others);
    let mut second: Vec<u32> = (0..shared as u32).collect();
    second.extend((3..).take(others.len()));
    audit(&vertices, &[[0, 1, 2], second.try_into().unwrap()]).intersections.pairs
}

#[test]
fn a_tetrahedron_is_clean() {
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let result = audit(&vertices, &faces);
    assert!(result.is_sound() && result.intersections.tested == 6, "{result:?}");
    // Without one face it is open, with one turned around it is not oriented.
    assert_eq!(audit(&vertices, &faces[..3]).topology.border_edges, 3);
    let turned = [[0, 1, 2], faces[1], faces[2], faces[3]];
    assert!(audit(&vertices, &turned).topology.misoriented_edges > 0);
    let more = [vertices.as_slice(), &[[9.0; 3]]].concat();
    assert_eq!(audit(&more, &faces).topology.unreferenced_vertices, 1);
}

#[test]
fn two_tetrahedra_at_a_vertex_are_not_manifold() {
    let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut all = vertices.to_vec();
    all.extend(vertices[1..].iter().map(|v| v.map(|x| -x)));
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut both = faces.to_vec();
    both.extend(faces.map(|t| t.map(|v| if v == 0 { 0 } else { v + 3 })).map(|[a, b, c]| [a, c, b]));
    let result = audit(&all, &both);
    let topology = &result.topology;
    assert_eq!((topology.border_edges, topology.non_manifold_edges, topology.misoriented_edges), (0, 0, 0));
    assert_eq!((topology.non_manifold_vertices, result.intersections.pairs), (1, 0));
}

#[test]
fn disjoint_triangles() {
    assert_eq!(against_base(0, &[[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]]), 1, "crossing");
    assert_eq!(against_base(0, &[[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), 1, "touching vertex");
    assert_eq!(against_base(0, &[[2.0, 0.0, 0.0], [2.0, -1.0, 1.0], [2.0, -1.0, -1.0]]), 1, "on the border");
    assert_eq!(against_base(0, &[[2.0, -1e-9, 0.0], [2.0, -1.0, 1.0], [2.0, -1.0, -1.0]]), 0, "just off");
    assert_eq!(against_base(0, &[[1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [1.0, 2.0, 0.0]]), 1, "coplanar within");
    assert_eq!(against_base(0, &[[-1.0, -1.0, 0.0], [9.0, -1.0, 0.0], [-1.0, 9.0, 0.0]]), 1, "around");
    assert_eq!(against_base(0, &[[-1.0, 1.0, 0.0], [5.0, 1.0, 0.0], [-1.0, 1.5, 0.0]]), 1, "coplanar across");
    assert_eq!(against_base(0, &[[4.0, 4.0, 0.0], [5.0, 0.1, 0.0], [5.0, 5.0, 0.0]]), 0, "coplanar apart");
    assert_eq!(against_base(0, &[[1.0, 1.0, 1e-9], [2.0, 1.0, 1e-9], [1.0, 2.0, 1e-9]]), 0, "just above");
    assert_eq!(against_base(0, &BASE), 1, "the same position twice, welded");
}

#[test]
fn triangles_with_a_common_vertex() {
    assert_eq!(against_base(1, &[[1.0, 1.0, 1.0], [1.0, 1.0, -1.0]]), 1, "through the inside");
    assert_eq!(against_base(1, &[[3.0, 3.0, 1.0], [3.0, 3.0, -1.0]]), 1, "through the opposite side");
    assert_eq!(against_base(1, &[[2.0, 2.0, 0.0], [3.0, 3.0, -1.0]]), 1, "touching the opposite side");
    assert_eq!(against_base(1, &[[1.0, 2.0, 0.0], [2.0, 1.0, 0.0]]), 1, "coplanar overlap");
    assert_eq!(against_base(1, &[[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), 0, "coplanar apart");
    assert_eq!(against_base(1, &[[1.0, 1.0, 1.0], [1.0, 2.0, 1.0]]), 0, "above");
}

#[test]
fn triangles_with_a_common_edge() {
    assert_eq!(against_base(2, &[[1.0, 1.0, 0.0]]), 1, "fold");
    assert_eq!(against_base(2, &[[1.0, 1.0, 1e-300]]), 0, "almost a fold");
    assert_eq!(against_base(2, &[[1.0, -1.0, 0.0]]), 0, "flat continuation");
    assert_eq!(audit(&BASE, &[[0, 1, 2], [0, 2, 1]]).intersections.pairs, 1, "the same triangle twice");
}

#[test]
fn degenerate_triangles() {
    let line = [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.3, 0.3, 0.3], [0.1, 0.2, 0.7]];
    // 0.1, 0.2 and 0.3 are no exact multiples, but three equal coordinates are collinear exactly.
    assert_eq!(audit(&line, &[[0, 1, 2]]).topology.degenerate_triangles, 1);
    assert_eq!(audit(&line, &[[0, 1, 3]]).topology.degenerate_triangles, 0);
    assert_eq!(audit(&line, &[[0, 3, 3]]).topology.degenerate_triangles, 1);
}
