use super::*;
use crate::mesh::TriMesh;
use glam::DVec3;
use proptest::prelude::*;

/// Returns the oracle: every triangle, in order.
fn brute_force(tree: &Ssvh, p: DVec3) -> Hit {
    (0..tree.len() as u32)
        .map(|triangle| Hit { triangle, distance_squared: tree.triangle(triangle).distance_squared(p) })
        .min_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.triangle.cmp(&b.triangle)))
        .expect("triangles")
}

/// Pseudo-random numbers in 0..1, the same on every run.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

/// Returns a soup of `count` triangles of about `size` in the unit cube, moved by `offset`, with
/// nasty ones mixed in.
fn soup(count: usize, size: f64, offset: f64, seed: u64) -> TriMesh {
    let mut state = seed;
    let mut mesh = TriMesh::default();
    for i in 0..count {
        let base: [f64; 3] = std::array::from_fn(|_| random(&mut state) + offset);
        let mut corner =
            || -> [f64; 3] { std::array::from_fn(|a| base[a] + size * (random(&mut state) - 0.5)) };
        let (a, b, mut c) = (corner(), corner(), corner());
        match i % 5 {
            // A needle whose height is a millionth of its length.
            0 => c = std::array::from_fn(|k| a[k] * 0.3 + b[k] * 0.7 + 1e-6 * size * (c[k] - a[k])),
            // Coplanar with many others.
            1 => c[2] = a[2],
            // A segment.
            2 if i % 3 == 0 => c = a,
            _ => {}
        }
        let n = mesh.vertices.len() as u32;
        mesh.vertices.extend([a, b, c]);
        mesh.triangles.push([n, n + 1, n + 2]);
        if i % 7 == 0 {
            // A second triangle on the same edge, and a copy far below it in number.
            mesh.vertices.push(corner_of(&mut state, offset));
            mesh.triangles.push([n + 1, n, n + 3]);
            mesh.triangles.push([n, n + 1, n + 2]);
        }
    }
    mesh
}

fn corner_of(state: &mut u64, offset: f64) -> [f64; 3] {
    std::array::from_fn(|_| random(state) + offset)
}

fn check(mesh: &TriMesh, queries: usize, spread: f64) {
    let tree = Ssvh::new(mesh);
    tree.validate().unwrap();
    let mut state = 99;
    let centre = DVec3::from(mesh.vertices[0]);
    for i in 0..queries {
        let mut p = centre + spread * DVec3::from(std::array::from_fn(|_| random(&mut state) - 0.5));
        if i % 4 == 0 {
            // Exactly on a vertex.
            p = DVec3::from(mesh.vertices[i * 31 % mesh.vertices.len()]);
        }
        let expected = brute_force(&tree, p);
        assert_eq!(tree.closest(p), expected, "{p}");
        assert_eq!(tree.closest_from(p, (i * 17 % tree.len()) as u32), expected, "{p}");
        let distance = expected.distance_squared.sqrt();
        assert_eq!(tree.closest_within(p, distance * 1.001 + 1e-12), Some(expected));
        if distance > 0.0 {
            assert_eq!(tree.closest_within(p, distance * 0.999), None);
        }
    }
}

#[test]
fn equals_brute_force_on_soups() {
    for (count, size) in [(1, 1.0), (8, 0.5), (9, 0.5), (64, 0.3), (65, 0.1), (600, 0.05), (3000, 0.02)] {
        check(&soup(count, size, 0.0, count as u64), 200, 3.0);
    }
}

#[test]
fn equals_brute_force_far_from_the_origin() {
    check(&soup(500, 0.1, 1e6, 3), 200, 3.0);
    check(&soup(500, 0.1, -1e6, 4), 200, 3e3);
}

#[test]
fn equals_brute_force_far_from_the_mesh() {
    check(&soup(500, 0.1, 0.0, 5), 100, 1e4);
}

#[test]
fn equals_brute_force_with_long_thin_triangles() {
    let mut mesh = soup(400, 0.05, 0.0, 6);
    for v in &mut mesh.vertices {
        v[0] *= 1e4;
    }
    check(&mesh, 300, 1e4);
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let mesh = soup(20_000, 0.02, 0.0, 7);
    let trees = [1, 2, 8].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Ssvh::new(&mesh))
    });
    assert_eq!(trees[0].ids, trees[1].ids);
    assert_eq!(trees[0].ids, trees[2].ids);
}

#[test]
fn eight_points_at_once_find_the_same_as_one_at_a_time() {
    for (count, size, offset) in [(5, 1.0, 0.0), (3000, 0.02, 0.0), (700, 0.1, 1e6)] {
        let mesh = soup(count, size, offset, 11);
        let tree = Ssvh::new(&mesh);
        let mut state = 5;
        for n in 0..200 {
            let spread = [1e-3, 0.05, 2.0][n % 3];
            let centre = DVec3::from(mesh.vertices[n * 7 % mesh.vertices.len()]);
            let points = std::array::from_fn(|_| {
                centre + spread * DVec3::from(std::array::from_fn(|_| random(&mut state) - 0.5))
            });
            let hits = tree.closest8(&points, (n % tree.len()) as u32);
            for (p, hit) in points.into_iter().zip(hits) {
                assert_eq!(hit, brute_force(&tree, p), "{p}");
            }
        }
    }
}

proptest! {
    #[test]
    fn equals_brute_force_on_any_soup(
        vertices in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 3..60),
        q in prop::array::uniform3(-2.0..2.0f64),
    ) {
        let n = vertices.len() as u32;
        let triangles = (0..n).map(|i| [i, (i * 7 + 1) % n, (i * 3 + 2) % n]).collect();
        let tree = Ssvh::new(&TriMesh { vertices, triangles });
        let q = DVec3::from(q);
        prop_assert_eq!(tree.closest(q), brute_force(&tree, q));
    }
}
