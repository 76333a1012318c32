//! Each planted defect is found, and nothing else.

use super::audit::audit;
use crate::mesh::{TriMesh, shapes};
use crate::verify::{Promise, Soundness};

fn promises(found: &Soundness) -> Vec<Promise> {
    let mut promises: Vec<Promise> = found.broken().into_iter().map(|b| b.promise).collect();
    promises.dedup();
    promises
}

fn moved(mut mesh: TriMesh, by: [f64; 3]) -> TriMesh {
    mesh.vertices.iter_mut().for_each(|v| (0..3).for_each(|a| v[a] += by[a]));
    mesh
}

fn together(mut a: TriMesh, b: &TriMesh) -> TriMesh {
    let first = a.vertices.len() as u32;
    a.vertices.extend(&b.vertices);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    a
}

/// As STL has it: no vertex belongs to two triangles.
fn exploded(mesh: &TriMesh) -> TriMesh {
    let vertices: Vec<[f64; 3]> = (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).collect();
    let triangles = (0..mesh.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriMesh { vertices, triangles }
}

#[test]
fn generated_models_are_sound() {
    for shape in shapes::ALL {
        let found = audit(&(shape.make)(6));
        match shape.name {
            "wave" => assert_eq!(promises(&found), [Promise::Closed]),
            "touching_spheres" => {
                assert_eq!(promises(&found), [Promise::Manifold]);
                assert_eq!(found.topology.non_manifold_vertices, 1);
            }
            name => assert!(found.is_sound(), "{name}: {found:?}"),
        }
    }
    let tori = audit(&shapes::linked_tori(6)).topology;
    assert_eq!((tori.components, tori.euler, tori.genus), (2, 0, Some(2)));
    let sphere = audit(&exploded(&shapes::sphere(6))).topology;
    assert_eq!((sphere.components, sphere.euler, sphere.genus), (1, 2, Some(0)));
    assert!(sphere.welded_vertices > sphere.vertices);
}

#[test]
fn a_flipped_triangle() {
    let mut mesh = shapes::sphere(6);
    mesh.triangles[17].swap(0, 1);
    let found = audit(&mesh);
    assert_eq!((promises(&found), found.topology.misoriented_edges), (vec![Promise::Oriented], 3));
    assert!(found.topology.first_misoriented.is_some());
}

#[test]
fn a_removed_triangle() {
    let mut mesh = shapes::sphere(6);
    let corners = mesh.corners(17);
    mesh.triangles.remove(17);
    let found = audit(&mesh);
    assert_eq!((promises(&found), found.topology.border_edges), (vec![Promise::Closed], 3));
    assert!(found.topology.first_border.unwrap().iter().all(|p| corners.contains(p)));
    assert_eq!(found.topology.genus, None);
}

#[test]
fn two_spheres_pushed_through_each_other() {
    let sphere = shapes::sphere(6);
    let mesh = together(sphere.clone(), &moved(sphere, [1.2, 0.07, 0.03]));
    let found = audit(&mesh);
    assert_eq!(promises(&found), [Promise::NoIntersections]);
    assert_eq!(found.topology.components, 2);
    let brute = (0..mesh.triangles.len() as u32)
        .flat_map(|a| (0..a).map(move |b| (b, a)))
        .filter(|&(a, b)| crate::verify::intersections::meeting_point(&mesh, a, b).is_some())
        .count();
    assert!(brute > 20);
    assert_eq!(found.intersections.pairs, brute as u64);
    // The points are on both spheres, up to the height of a facet.
    for pair in &found.intersections.first {
        let p = pair.point;
        let radius = |c: [f64; 3]| (0..3).map(|i| (p[i] - c[i]).powi(2)).sum::<f64>().sqrt();
        assert!((radius([0.0; 3]) - 1.0).abs() < 0.05 && (radius([1.2, 0.07, 0.03]) - 1.0).abs() < 0.05);
    }
}

#[test]
fn a_fold() {
    // A vertex of a flat face pulled over its neighbours, within the plane: coplanar overlaps that
    // share edges.
    let mut mesh = shapes::cube(4);
    let inner = |v: &[f64; 3]| v[2] == 1.0 && v[0].abs() < 0.99 && v[1].abs() < 0.99;
    let v = mesh.vertices.iter().position(inner).unwrap();
    mesh.vertices[v] = [0.9, 0.9, 1.0];
    let found = audit(&mesh);
    assert_eq!(promises(&found), [Promise::NoIntersections]);
    assert!(found.intersections.pairs > 3);
}

#[test]
fn a_duplicated_sheet() {
    let mut mesh = shapes::cube(4);
    let sheet: Vec<[u32; 3]> = (0..mesh.triangles.len())
        .filter(|&t| mesh.corners(t).iter().all(|p| p[2] == 1.0))
        .map(|t| mesh.triangles[t])
        .collect();
    let all = mesh.triangles.len();
    mesh.triangles.extend(&sheet);
    let found = audit(&mesh);
    assert_eq!(found.topology.duplicate_triangles, sheet.len());
    assert_eq!(found.topology.first_duplicate, Some(all as u32));
    assert_eq!(promises(&found), [Promise::Manifold, Promise::NoIntersections]);
    assert_eq!(found.topology.triangles, all + sheet.len());
    // Each with its copy.
    assert!(found.intersections.pairs >= sheet.len() as u64);
}

#[test]
fn degenerate_triangles_are_counted_not_dropped() {
    let mut mesh = shapes::sphere(4);
    let [a, b, _] = mesh.triangles[5];
    mesh.triangles.insert(0, [a, b, b]);
    let found = audit(&mesh);
    assert_eq!(promises(&found), [Promise::NotDegenerate]);
    assert_eq!((found.topology.degenerate_triangles, found.topology.first_degenerate), (1, Some(0)));
    assert_eq!(found.topology.triangles, mesh.triangles.len());

    // A vertex on an edge: flat, yet a part of the topology.
    let (p, q) = (mesh.vertices[a as usize], mesh.vertices[b as usize]);
    let middle = [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
    mesh.triangles[0] = [a, b, mesh.vertices.len() as u32];
    mesh.vertices.push(middle);
    assert_eq!(audit(&mesh).topology.degenerate_triangles, usize::from(exactly_between(p, middle, q)));
}

fn exactly_between(p: [f64; 3], m: [f64; 3], q: [f64; 3]) -> bool {
    crate::geom::predicates::projection_axis([p, m, q]).is_none()
}

#[test]
fn numbers_are_those_of_the_file() {
    let sphere = shapes::sphere(4);
    let mut mesh = together(sphere.clone(), &moved(sphere, [1.2, 0.07, 0.03]));
    let before = audit(&mesh).intersections.first[0].triangles;
    mesh.triangles.insert(0, [0, 0, 1]);
    let after = audit(&mesh).intersections.first[0].triangles;
    assert_eq!(after, before.map(|t| t + 1));
}

#[test]
fn slivers_are_measured() {
    let mesh =
        TriMesh { vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.01, 0.0]], triangles: vec![[0, 1, 2]] };
    let topology = audit(&mesh).topology;
    assert_eq!((topology.slivers, topology.smallest_angle_triangle), (1, Some(0)));
    assert!((topology.smallest_angle.unwrap() - 0.01f64.atan().to_degrees()).abs() < 1e-12);
}

#[test]
fn the_report_does_not_depend_on_the_threads() {
    let sphere = shapes::sphere(16);
    let mesh = together(sphere.clone(), &moved(sphere, [1.2, 0.07, 0.03]));
    let of = |threads| {
        crate::verify::soundness(&mesh, &crate::run::RunSettings::with_threads(threads).unwrap()).unwrap()
    };
    assert_eq!(of(1), of(3));
}
