//! The intersecting pairs of whole meshes against exact rationals, by brute force.

use super::audit::audit;
use crate::geom::predicates::projection_axis;
use crate::geom::triangle_pair::oracle::{exact_point, meet_elsewhere};
use crate::mesh::TriMesh;
use num_rational::Ratio;
use proptest::prelude::*;

/// Nodes of the grid along x, y and z.
const GRID: [u32; 3] = [4, 4, 3];

/// A mesh on the nodes of the grid; its triangles are arbitrary, and some have no area.
fn mesh_on_a_grid() -> impl Strategy<Value = TriMesh> {
    let [x, y, z] = GRID;
    let node = 0..x * y * z;
    let triangles = prop::collection::vec(prop::array::uniform3(node.clone()), 2..40);
    triangles.prop_map(move |triangles| {
        let position = |n: u32| [n / (y * z), n / z % y, n % z].map(f64::from);
        TriMesh { vertices: node.clone().map(position).collect(), triangles }
    })
}

/// Returns the intersecting pairs of triangles with area, in ascending order.
fn pairs_by_brute_force(mesh: &TriMesh) -> Vec<[u32; 2]> {
    let has_area = |t: &usize| projection_axis(mesh.corners(*t)).is_some();
    let all: Vec<usize> = (0..mesh.triangles.len()).filter(has_area).collect();
    let exact = |t: usize| mesh.corners(t).map(exact_point::<Ratio<i128>>);
    let meet =
        |a: usize, b: usize| meet_elsewhere(mesh.triangles[a], &exact(a), mesh.triangles[b], &exact(b));
    let pairs = all.iter().flat_map(|&a| all.iter().filter(move |&&b| a < b).map(move |&b| (a, b)));
    pairs.filter(|&(a, b)| meet(a, b)).map(|(a, b)| [a as u32, b as u32]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn all_pairs_of_any_mesh_are_found(mesh in mesh_on_a_grid()) {
        let expected = pairs_by_brute_force(&mesh);
        let found = audit(&mesh).intersections;
        prop_assert_eq!(found.pairs, expected.len() as u64);
        let first: Vec<[u32; 2]> = found.first.iter().map(|pair| pair.triangles).collect();
        // Ten pairs are located.
        prop_assert_eq!(&first[..], &expected[..expected.len().min(10)]);
    }
}
