//! Closed meshes stay closed, and keep their volume.

use proptest::prelude::*;

use crate::mesh::{CleanReport, Topology, TriMesh, clean, measure, shapes};

type Point = [f64; 3];

/// Returns the tetrahedron with a corner at the origin and edges of length 4 along the axes.
fn tetrahedron() -> TriMesh {
    TriMesh {
        vertices: vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    }
}

/// Cleans a mesh that is closed, and checks that it is so afterwards, with the volume it had.
#[track_caller]
fn clean_closed(mesh: TriMesh) -> (TriMesh, CleanReport) {
    assert!(Topology::new(&mesh).defects().is_closed(), "the test begins with a closed mesh");
    let before = measure::signed_volume(&mesh);
    let (cleaned, report) = clean(mesh);
    // What is there twice stays once, which is no longer closed.
    assert_eq!(report.duplicate_triangles, 0);
    let defects = *Topology::new(&cleaned).defects();
    assert!(defects.is_closed(), "{defects:?}");
    assert!(super::degenerate(&cleaned.triangles, &cleaned.vertices).is_empty());
    assert!((measure::signed_volume(&cleaned) - before).abs() <= 1e-12 * (1.0 + before.abs()));
    assert!(clean(cleaned.clone()).1.is_clean());
    (cleaned, report)
}

/// Puts a triangle without area between triangle `t` and its neighbour along the edge from corner
/// `k` on: the neighbour gets the new vertex `middle`, `t` does not.
fn wedge(mesh: &mut TriMesh, t: usize, k: usize, middle: Point) {
    let corners = mesh.triangles[t];
    let (a, b) = (corners[k], corners[(k + 1) % 3]);
    let runs = |t: &[u32; 3]| (0..3).find(|&i| (t[i], t[(i + 1) % 3]) == (b, a));
    let (n, i) = (0..mesh.triangles.len())
        .filter(|&n| n != t)
        .find_map(|n| Some((n, runs(&mesh.triangles[n])?)))
        .expect("the mesh is closed");
    let m = mesh.vertices.len() as u32;
    mesh.vertices.push(middle);
    let mut other = mesh.triangles[n];
    mesh.triangles[n][(i + 1) % 3] = m;
    other[i] = m;
    mesh.triangles.extend([other, [b, a, m]]);
}

/// Returns the point between the corners `k` and `k + 1` of a triangle at `share` of 4 parts.
fn between(mesh: &TriMesh, t: usize, k: usize, share: f64) -> Point {
    let corners = mesh.corners(t);
    let (a, b) = (corners[k], corners[(k + 1) % 3]);
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share / 4.0)
}

#[test]
fn a_middle_vertex_on_a_shared_edge_goes_to_both_sides() {
    for t in 0..4 {
        for k in 0..3 {
            let mut mesh = tetrahedron();
            let middle = between(&mesh, t, k, 1.0);
            wedge(&mut mesh, t, k, middle);
            let (cleaned, report) = clean_closed(mesh);
            assert_eq!((report.degenerate_triangles, report.split_triangles), (1, 1));
            assert_eq!((cleaned.vertices.len(), cleaned.triangles.len()), (5, 6));
            assert_eq!(
                report.to_string(),
                "split 1 triangle at a vertex on its edge, dropped 1 degenerate triangle"
            );
        }
    }
}

#[test]
fn two_triangles_back_to_back_on_one_edge() {
    for (first, second) in [(1.0, 3.0), (3.0, 1.0), (2.0, 1.0)] {
        let mut mesh = tetrahedron();
        let (m, n) = (between(&mesh, 0, 0, first), between(&mesh, 0, 0, second));
        wedge(&mut mesh, 0, 0, m);
        // The other side of the long edge, which has not moved: between the triangle and the first
        // wedge.
        let last = mesh.triangles.len() - 1;
        wedge(&mut mesh, last, 0, n);
        let (cleaned, report) = clean_closed(mesh);
        assert_eq!(report.degenerate_triangles, 2);
        assert_eq!((cleaned.vertices.len(), cleaned.triangles.len()), (6, 8));
    }
}

#[test]
fn a_chain_along_an_edge() {
    let mut mesh = tetrahedron();
    for share in [2.0, 1.0, 3.0] {
        let middle = between(&tetrahedron(), 0, 0, share);
        // Always beside the triangle itself, so that the last one has all the others beyond it.
        wedge(&mut mesh, 0, 0, middle);
    }
    let (cleaned, report) = clean_closed(mesh);
    // The second and the third wedge have split the one before them, and the far side lacks their
    // vertices, too.
    assert_eq!((report.degenerate_triangles, report.split_triangles), (5, 3));
    assert_eq!((cleaned.vertices.len(), cleaned.triangles.len()), (7, 10));
}

#[test]
fn several_edges_of_one_triangle() {
    let mut mesh = tetrahedron();
    for k in 0..3 {
        let middle = between(&mesh, 1, k, 2.0);
        wedge(&mut mesh, 1, k, middle);
    }
    let (cleaned, report) = clean_closed(mesh);
    assert_eq!((report.degenerate_triangles, report.split_triangles), (3, 1));
    assert_eq!(cleaned.triangles.len(), 10);
}

/// Corners that are on a line exactly, which rounding would deny, and a neighbour far thinner than
/// its edge is long.
#[test]
fn needles_in_floating_point() {
    let mut mesh = TriMesh {
        vertices: vec![[0.1, 0.1, 0.1], [0.7, 0.7, 0.7], [0.3, 0.3, 0.3f64.next_up()], [0.4, 0.1, 0.9]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    };
    wedge(&mut mesh, 1, 0, [0.3, 0.3, 0.3]);
    let (cleaned, report) = clean_closed(mesh);
    assert_eq!((report.degenerate_triangles, report.split_triangles), (1, 1));
    assert_eq!(cleaned.triangles.len(), 6);
}

#[test]
fn at_a_border_the_triangle_is_dropped_and_the_points_of_the_border_stay() {
    // A square with a vertex on its border that only a triangle without area has.
    let vertices = vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]];
    let square = [[0, 1, 2], [0, 2, 3]];
    let split = vec![[4, 1, 2], [0, 4, 2], [0, 2, 3]];
    for (flat, expected) in [([0, 4, 1], split.clone()), ([1, 0, 4], split)] {
        let mesh = TriMesh { vertices: vertices.clone(), triangles: [&square[..], &[flat]].concat() };
        let (cleaned, report) = clean(mesh);
        assert_eq!(cleaned.triangles, expected, "{flat:?}");
        assert_eq!((report.degenerate_triangles, report.split_triangles), (1, 1));
    }
    // With the vertex on the side of the square that is split, the long edge is the border.
    let triangles = vec![[0, 4, 2], [4, 1, 2], [0, 2, 3], [1, 4, 0]];
    let (cleaned, report) = clean(TriMesh { vertices, triangles: triangles.clone() });
    assert_eq!(cleaned.triangles, triangles[..3]);
    assert_eq!((report.degenerate_triangles, report.split_triangles), (1, 0));
}

#[test]
fn both_sides_of_a_triangle_without_area_vanish() {
    let mut mesh = tetrahedron();
    mesh.vertices.extend([[8.0, 0.0, 0.0], [9.0, 0.0, 0.0], [10.0, 0.0, 0.0]]);
    mesh.triangles.extend([[4, 5, 6], [6, 5, 4]]);
    let (cleaned, report) = clean_closed(mesh);
    assert_eq!((report.degenerate_triangles, report.split_triangles), (2, 0));
    assert_eq!(cleaned, tetrahedron());
}

#[test]
fn a_doubled_mesh_is_one_mesh() {
    let mut mesh = tetrahedron();
    wedge(&mut mesh, 2, 1, [0.0, 2.0, 2.0]);
    let doubled = TriMesh { triangles: mesh.triangles.repeat(2), ..mesh.clone() };
    let ((once, _), (twice, report)) = (clean(mesh), clean(doubled));
    assert_eq!(once, twice);
    assert_eq!((report.degenerate_triangles, report.duplicate_triangles), (2, 5));
    assert_eq!(report.split_triangles, 1);
}

#[test]
fn what_is_not_touched_keeps_its_order() {
    let mut mesh = shapes::anchor(4);
    let before = mesh.triangles.clone();
    let middle = between(&mesh, 7, 1, 2.0);
    wedge(&mut mesh, 7, 1, middle);
    let (cleaned, report) = clean_closed(mesh);
    assert_eq!((report.degenerate_triangles, report.split_triangles), (1, 1));
    assert_eq!((&cleaned.triangles[..7], cleaned.triangles.len()), (&before[..7], before.len() + 2));
}

proptest! {
    /// Wedges at random places, also beside and across other wedges; the triangles in any order.
    #[test]
    fn any_wedges_in_a_closed_mesh(
        wedges in prop::collection::vec((any::<prop::sample::Index>(), 0usize..3, 1u8..4), 1..12),
        order in any::<u64>(),
    ) {
        let mut mesh = tetrahedron();
        for (t, k, share) in wedges {
            let t = t.index(mesh.triangles.len());
            let middle = between(&mesh, t, k, share.into());
            wedge(&mut mesh, t, k, middle);
        }
        let count = mesh.triangles.len() as u64;
        mesh.triangles.sort_by_key(|t| (u64::from(t[0] ^ t[1]) * 7 + order) % count);
        prop_assume!(clean(mesh.clone()).1.duplicate_triangles == 0);
        clean_closed(mesh);
    }

    /// Sums of tetrahedra, flat ones and lines among them, on a lattice where corners often lie on
    /// a line.
    #[test]
    fn any_sum_of_tetrahedra(corners in prop::collection::vec(prop::array::uniform4(0u32..27), 1..8)) {
        let vertices = (0..27u8).map(|i| [i % 3, i / 3 % 3, i / 9].map(f64::from)).collect();
        let triangles =
            corners.iter().flat_map(|&[a, b, c, d]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]).collect();
        let mesh = TriMesh { vertices, triangles };
        let defects = *Topology::new(&TriMesh {
            triangles: mesh.triangles.iter().copied().filter(|&t| !super::has_equal(t)).collect(),
            ..mesh.clone()
        }).defects();
        prop_assert!(defects.is_closed());
        let (cleaned, report) = clean(mesh.clone());
        prop_assume!(report.duplicate_triangles == 0);
        prop_assert!(Topology::new(&cleaned).defects().is_closed());
        prop_assert!(super::degenerate(&cleaned.triangles, &cleaned.vertices).is_empty());
        let volumes = [&mesh, &cleaned].map(|m| (6.0 * measure::signed_volume(m)).round());
        prop_assert_eq!(volumes[0], volumes[1]);
    }
}
