use super::*;
use crate::mesh::TriMesh;
use crate::mesh::measure::signed_volume;
use std::collections::BTreeMap;

/// Counts the occurrences of each directed edge.
fn directed_edges(mesh: &TriMesh) -> BTreeMap<(u32, u32), u32> {
    let mut count = BTreeMap::new();
    for [a, b, c] in &mesh.triangles {
        for edge in [(*a, *b), (*b, *c), (*c, *a)] {
            *count.entry(edge).or_default() += 1;
        }
    }
    count
}

#[test]
fn closed_models_pair_every_directed_edge_once() {
    for shape in ALL.iter().filter(|s| s.volume.is_some()) {
        for detail in [0, 5, DEFAULT_DETAIL] {
            let edges = directed_edges(&(shape.make)(detail));
            for ((a, b), n) in &edges {
                assert_eq!(*n, 1, "{}: edge {a} {b} occurs {n} times", shape.name);
                assert!(edges.contains_key(&(*b, *a)), "{}: edge {a} {b} has no opposite", shape.name);
            }
        }
    }
}

#[test]
fn the_wave_is_open_and_consistently_oriented() {
    let edges = directed_edges(&wave(DEFAULT_DETAIL));
    assert!(edges.values().all(|n| *n == 1));
    let border = edges.keys().filter(|(a, b)| !edges.contains_key(&(*b, *a))).count();
    assert_eq!(border, 4 * 32);
}

#[test]
fn volumes_are_the_closed_forms() {
    for shape in ALL {
        let Some(volume) = shape.volume else { continue };
        let error = |detail| signed_volume(&(shape.make)(detail)) / volume.value() - 1.0;
        match volume {
            Volume::Exact(_) => assert!(error(7).abs() < 1e-12, "{}: {}", shape.name, error(7)),
            Volume::Limit(_) => {
                let (coarse, fine) = (error(12), error(48));
                assert!(coarse.abs() < 0.03, "{}: {coarse}", shape.name);
                // 16 at second order; patches that are triangulated anew need not come close to it.
                assert!(fine.abs() < coarse.abs() / 8.0, "{}: {coarse} {fine}", shape.name);
            }
        }
    }
}

#[test]
fn no_triangle_is_degenerate_and_no_vertex_idle() {
    for shape in ALL {
        let mesh = (shape.make)(DEFAULT_DETAIL);
        assert!((300..50_000).contains(&mesh.triangles.len()), "{}: {}", shape.name, mesh.triangles.len());
        let mut used = vec![false; mesh.vertices.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            triangle.iter().for_each(|v| used[*v as usize] = true);
            let [a, b, c] = mesh.corners(t);
            let side = |p: [f64; 3], q: [f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt();
            let (x, y, z) = (side(a, b), side(b, c), side(c, a));
            let longest = x.max(y).max(z);
            let height =
                ((x + y + z) * (y + z - x) * (z + x - y) * (x + y - z)).max(0.0).sqrt() / (2.0 * longest);
            assert!(height > 0.01 * longest, "{}: triangle {t} is a sliver {height} {longest}", shape.name);
        }
        assert!(used.iter().all(|u| *u), "{}: a vertex belongs to no triangle", shape.name);
    }
}

#[test]
fn models_are_the_same_each_time() {
    for shape in ALL {
        assert_eq!((shape.make)(9), (shape.make)(9), "{}", shape.name);
    }
}

#[test]
fn touching_spheres_share_one_vertex() {
    let (one, two) = (sphere(8), touching_spheres(8));
    assert_eq!(two.vertices.len(), 2 * one.vertices.len() - 1);
    assert_eq!(two.vertices.iter().filter(|v| **v == [0.0; 3]).count(), 1);
}

#[test]
fn names_are_unique_and_found() {
    for shape in ALL {
        let found = by_name(&shape.name.replace('_', "-")).unwrap();
        assert!(std::ptr::eq(found, shape));
    }
    assert!(by_name("teapot").is_none());
}
