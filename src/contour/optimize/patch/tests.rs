use super::*;
use crate::band::LeafId;
use crate::contour::mesh::{CHANGED, LeafMesh, VertexRun};
use crate::mesh::{Topology, TriMesh, shapes};
use crate::verify::tests::audit::audit;

const EVERYWHERE: Bounds = Bounds { lo: [-100.0; 3], hi: [100.0; 3] };

/// All of a mesh as a patch.
fn patch_within(mesh: &TriMesh, bounds: Bounds, home: Bounds) -> Patch {
    let mut patch = Patch::new(bounds, [home; 27]);
    for (number, &vertices) in mesh.triangles.iter().enumerate() {
        patch.add(number, &vertices, &mesh.corners(number), 0);
    }
    patch
}

fn patch(mesh: &TriMesh) -> Patch {
    patch_within(mesh, EVERYWHERE, EVERYWHERE)
}

/// The mesh with what a patch changed.
fn changed(mesh: &TriMesh, patch: Patch) -> TriMesh {
    let firsts = vec![0, mesh.triangles.len()];
    let runs = vec![VertexRun { leaf: LeafId(0), numbers: 0..mesh.vertices.len() as u32 }];
    let edges = vec![CHANGED; mesh.triangles.len()];
    let changed = vec![(0..mesh.triangles.len()).collect()];
    let mut changed = LeafMesh {
        mesh: mesh.clone(),
        firsts,
        edges,
        changed,
        added: vec![Vec::new()],
        removed: Vec::new(),
        runs,
    };
    changed.apply(LeafId(0), patch.changes);
    changed.into_ordered().mesh
}

fn octahedron(centre: [f64; 3]) -> TriMesh {
    let vertex = |n: usize| {
        let mut p = centre;
        p[n / 2] += if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        p
    };
    let triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    TriMesh { vertices: (0..6).map(vertex).collect(), triangles }
}

fn both(mut a: TriMesh, b: &TriMesh) -> TriMesh {
    let first = a.vertices.len() as u32;
    a.vertices.extend(&b.vertices);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| first + v)));
    a
}

/// Vertices less half the triangles: the Euler characteristic of a closed mesh.
fn euler(mesh: &TriMesh) -> i64 {
    mesh.vertices.len() as i64 - mesh.triangles.len() as i64 / 2
}

#[test]
fn a_vertex_does_not_go_through_or_onto_another_sheet() {
    let mesh = both(octahedron([0.0; 3]), &octahedron([2.5, 0.0, 0.0]));
    for (x, moves) in [(1.2, true), (1.5, false), (1.6, false), (5.0, false), (1.4999, true)] {
        let mut patch = patch(&mesh);
        assert_eq!(patch.try_move(0, [x, 0.0, 0.0]), moves, "{x}");
        assert!(audit(&changed(&mesh, patch)).is_sound(), "{x}");
    }
}

#[test]
fn a_vertex_does_not_flatten_its_triangles() {
    let mesh = octahedron([0.0; 3]);
    // Into the line of two others, and onto one.
    for to in [[0.0, 0.5, 0.5], [0.0, 1.0, 0.0]] {
        assert!(!patch(&mesh).try_move(0, to), "{to:?}");
    }
}

#[test]
fn nothing_leaves_the_bounds_or_its_home() {
    let mesh = octahedron([0.0; 3]);
    let wide = Bounds { lo: [-1.5; 3], hi: [1.5; 3] };
    assert!(patch_within(&mesh, wide, wide).try_move(0, [1.4, 0.0, 0.0]));
    assert!(!patch_within(&mesh, wide, EVERYWHERE).try_move(0, [1.6, 0.0, 0.0]));
    assert!(!patch_within(&mesh, EVERYWHERE, wide).try_move(0, [1.6, 0.0, 0.0]));
    // A vertex outside may have triangles that the patch does not hold.
    let narrow = Bounds { lo: [-0.5; 3], hi: [0.5; 3] };
    let mut patch = patch_within(&mesh, narrow, EVERYWHERE);
    assert!(!patch.try_move(0, [0.4, 0.0, 0.0]));
    assert!(!patch.try_collapse([0, 2], [0.4, 0.4, 0.0]));
}

#[test]
fn an_edge_is_not_doubled_by_a_flip() {
    // Every edge of a tetrahedron has the other one as its flip.
    let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = TriMesh { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] };
    let mut patch = patch(&mesh);
    for n in 0..4 {
        for side in 0..3 {
            let edge = patch.edge(n, side).unwrap();
            assert!(!patch.try_flip(&edge));
        }
    }
    // Nor may it be merged: nothing would be left of it.
    assert!(!patch.try_collapse([0, 1], [0.5, 0.0, 0.0]));
    assert!(patch.changes.triangles.is_empty() && patch.changes.moved.is_empty());
}

#[test]
fn a_neck_is_not_cut() {
    // Two tetrahedra on a common face that is not there: its edges lie on a way around the neck.
    let vertices =
        vec![[1.0, 0.0, 0.0], [-0.5, 0.9, 0.0], [-0.5, -0.9, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let triangles = vec![[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]];
    let mesh = TriMesh { vertices, triangles };
    assert!(audit(&mesh).is_sound());
    for edge in [[0, 1], [1, 2], [2, 0]] {
        assert!(!patch(&mesh).try_collapse(edge, [0.2, 0.1, 0.0]), "{edge:?}");
    }
    // An edge to a pole may go: a tetrahedron stays.
    let mut patch = patch(&mesh);
    assert!(patch.try_collapse([0, 3], [0.6, 0.0, 0.5]));
    let merged = changed(&mesh, patch);
    assert_eq!((merged.vertices.len(), merged.triangles.len()), (4, 4));
    assert!(audit(&merged).is_sound());
}

#[test]
fn edges_merge_and_split_without_a_trace_in_the_genus() {
    let mesh = octahedron([0.0; 3]);
    let mut patch = patch(&mesh);
    assert!(patch.try_collapse([0, 2], [0.6, 0.6, 0.0]));
    let edge = patch.edge(4, 0).or_else(|| patch.edge(1, 0)).unwrap();
    let middle = std::array::from_fn(|i| 0.55 * (edge.a.1[i] + edge.b.1[i]));
    assert!(patch.try_split_edge(&edge, middle).is_some());
    let result = changed(&mesh, patch);
    assert!(audit(&result).is_sound());
    assert_eq!((result.vertices.len(), result.triangles.len(), euler(&result)), (6, 8, 2));
}

#[test]
fn any_sequence_of_changes_leaves_a_sound_mesh() {
    for (name, seed) in [("sphere", 1u64), ("linked_tori", 2), ("bracket", 3), ("near_spheres", 4)] {
        let mesh = (shapes::by_name(name).unwrap().make)(5);
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut patch = patch(&mesh);
        let mut done = [0; 5];
        for _ in 0..1500 {
            let n = (random() * patch.triangles.len() as f64) as usize;
            if patch.is_gone(n) {
                continue;
            }
            let t = *patch.triangle_at(n);
            let mut near = |p: [f64; 3]| p.map(|x| x + 0.3 * (random() - 0.5));
            let centre = std::array::from_fn(|i| t.corners.iter().map(|c| c[i]).sum::<f64>() / 3.0);
            let (at, centre) = (near(t.corners[0]), near(centre));
            let kind = (random() * 5.0) as usize;
            let side = (random() * 3.0) as usize;
            let ok = match kind {
                0 => patch.try_move(t.vertices[0], at),
                1 => patch.edge(n, side).is_some_and(|edge| patch.try_flip(&edge)),
                2 => patch.try_split_face(n, centre).is_some(),
                3 => patch.edge(n, side).is_some_and(|edge| patch.try_split_edge(&edge, centre).is_some()),
                _ => patch
                    .try_collapse([t.vertices[0], t.vertices[1]], if side == 0 { at } else { t.corners[0] }),
            };
            done[kind] += usize::from(ok);
        }
        assert!(done.iter().all(|&n| n > 10), "{name}: {done:?}");
        let result = changed(&mesh, patch);
        assert!(audit(&result).is_sound(), "{name}: {done:?}");
        assert_eq!(euler(&result), euler(&mesh), "{name}");
        assert_eq!(Topology::new(&result).components(), Topology::new(&mesh).components(), "{name}");
    }
}
