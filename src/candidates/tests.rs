use super::*;
use crate::filter::Block;
use crate::lattice::{Ijk, Lattice};
use crate::mesh::TriMesh;
use crate::mesh::shapes;
use crate::ssvh::{Ssvh, TriangleSlot};
use glam::DVec3;
use proptest::prelude::*;

/// Returns a mesh whose triangles have nothing to do with one another, among them needles and one
/// that is larger than all else.
fn soup(corners: &[[[f64; 3]; 3]]) -> TriMesh {
    let vertices: Vec<[f64; 3]> = corners.iter().flatten().copied().collect();
    let triangles = (0..corners.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    TriMesh { vertices, triangles }
}

/// Prunes the lists of the leaf at `origin` and compares each with the hierarchy, at random points
/// of its blocks. Returns the numbers of triangles in the lists of the three depths.
fn check_leaf(mesh: &TriMesh, lattice: Lattice, origin: Ijk, shares: &[[f64; 3]]) -> [usize; 3] {
    let ssvh = Ssvh::new(mesh);
    let mut counts = [0; 3];
    let mut check = |pruner: &mut CandidatePruner, depth: usize, block: Block| {
        counts[depth] += pruner.count(depth);
        let list = pruner.list(depth).to_vec();
        for share in shares {
            let node = DVec3::from(block.origin.0.map(f64::from));
            let p = lattice.voxel * (node + f64::from(block.width) * DVec3::from(*share));
            let eight = ssvh.closest8_among(&list, &[p; 8]);
            assert!(eight.iter().all(|hit| *hit == ssvh.closest(p)), "{block:?} {p}");
        }
    };
    let leaf = Block { origin, width: 8 };
    let q = ssvh.triangle(ssvh.closest(leaf.centre(lattice)).triangle).closest(leaf.centre(lattice)).point;
    let mut pruner = CandidatePruner::default();
    assert!(pruner.collect(&ssvh, lattice, leaf, q, usize::MAX));
    check(&mut pruner, 0, leaf);
    let centres = |block: Block| {
        let octants = block.children();
        let width = octants[0].width;
        let centre = |octant: Block, axis: usize| {
            (octant.origin.0[axis] - origin.0[axis]) as f32 + 0.5 * (width - 1) as f32 - 3.5
        };
        std::array::from_fn(|axis| octants.map(|octant| centre(octant, axis)))
    };
    pruner.measure(0, &centres(leaf), 4);
    for (n, octant) in leaf.children().into_iter().enumerate() {
        pruner.prune(0, n);
        check(&mut pruner, 1, octant);
        pruner.measure(1, &centres(octant), 2);
        for (n, block) in octant.children().into_iter().enumerate() {
            let distance = f64::from(pruner.nearest(1, n).distance) * lattice.voxel;
            let exact = ssvh.closest(block.centre(lattice)).distance_squared.sqrt();
            let error = f64::from(pruner.nearest(1, n).error) * lattice.voxel;
            assert!((distance - exact).abs() <= error, "{distance} {exact} {error}");
            pruner.prune(1, n);
            check(&mut pruner, 2, block);
            check_nodes(&mut pruner, n, &centres(octant), &ssvh, lattice, block);
            let mut lists = BlockLists::default();
            lists.begin_leaf();
            let (slots, bounds) = pruner.bounded();
            lists.push(block.origin, slots, bounds);
            let lists = CandidateLists::new(lattice, [(vec![origin], lists)]);
            let near = lists.of_cell(block.origin).unwrap();
            let points: Vec<DVec3> = shares
                .iter()
                .map(|&share| {
                    let node = DVec3::from(block.origin.0.map(f64::from));
                    lattice.voxel * (node + 2.0 * DVec3::from(share))
                })
                .collect();
            for points in points.windows(8).step_by(3) {
                let points: [DVec3; 8] = points.try_into().unwrap();
                for count in [1, 3, 5, 8] {
                    let squared = ssvh.closest(points[0]).distance_squared;
                    // Nearer than expected, as near, and farther.
                    for expected in [f64::INFINITY, squared.sqrt(), 0.0] {
                        let hits = near.closest8(&ssvh, &points, count, expected);
                        for (hit, &p) in hits.iter().zip(&points).take(count) {
                            assert_eq!(*hit, ssvh.closest(p), "{block:?} {p}");
                            assert_eq!(near.closest(&ssvh, p), *hit);
                        }
                    }
                }
            }
        }
    }
    counts
}

/// Compares the closest triangles to the nodes of a block with the hierarchy, for all distances and
/// for some.
fn check_nodes(
    pruner: &mut CandidatePruner,
    n: usize,
    centres: &EightPoints,
    ssvh: &Ssvh,
    lattice: Lattice,
    block: Block,
) {
    let points = block.children().map(|node| DVec3::from(lattice.world_from_index(node.origin)));
    let exact = points.map(|p| ssvh.closest(p));
    let voxels = exact.map(|hit| hit.distance_squared.sqrt() / lattice.voxel);
    let near = voxels[5] as f32;
    for wanted in [[f32::NEG_INFINITY, f32::INFINITY], [near - 0.1, near + 0.1], [near, near], [0.0, near]] {
        let hits = pruner.closest_to_nodes(n, centres, ssvh, &points, wanted);
        for ((hit, exact), voxels) in hits.iter().zip(&exact).zip(voxels) {
            if hit.triangle != u32::MAX {
                assert_eq!(hit, exact, "{block:?} {wanted:?}");
                continue;
            }
            let [least, most] = wanted.map(f64::from);
            let distance = hit.distance_squared.sqrt() / lattice.voxel;
            assert!(
                voxels < least && distance < least || voxels > most && distance > most,
                "{voxels} {wanted:?}"
            );
        }
    }
}

fn shares(count: usize) -> Vec<[f64; 3]> {
    let mut state = 7u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let corners = (0..8).map(|n: i32| [n >> 2, n >> 1 & 1, n & 1].map(f64::from));
    corners.chain((0..count).map(|_| [random(), random(), random()])).collect()
}

#[test]
fn lists_name_the_closest_triangle_of_the_hierarchy() {
    let mesh = shapes::carved_cube(12);
    for (voxel, origin) in [(0.05, [8, -8, 16]), (0.01, [0, 40, -96]), (0.2, [-8, 0, 0]), (0.05, [160, 8, 8])]
    {
        let [leaf, octants, quarters] = check_leaf(&mesh, Lattice { voxel }, Ijk(origin), &shares(12));
        assert!(leaf > 0 && octants <= 8 * leaf && quarters <= 8 * octants, "{leaf} {octants} {quarters}");
    }
}

#[test]
fn lists_get_shorter() {
    let mesh = shapes::carved_cube(48);
    let [leaf, octants, quarters] = check_leaf(&mesh, Lattice { voxel: 0.01 }, Ijk([48, 16, -8]), &shares(2));
    assert!(octants < 8 * leaf / 2 && quarters < 8 * octants / 2, "{leaf} {octants} {quarters}");
    assert!(leaf < mesh.triangles.len() / 4, "{leaf} of {}", mesh.triangles.len());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn lists_of_anything_name_the_closest_triangle(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-1.0..1.0f64)), 1..60),
        squeeze in 0..3usize,
        far in prop::array::uniform3(-30..30i32),
        voxel in 0.005..0.2f64,
    ) {
        let mut corners = corners;
        for (n, t) in corners.iter_mut().enumerate() {
            match (n + squeeze) % 4 {
                // Needles, triangles without extent, and large ones.
                0 => t[2] = std::array::from_fn(|a| 0.3 * t[0][a] + 0.7 * t[1][a]),
                1 if n % 5 == 0 => t[1] = t[0],
                2 if n % 7 == 0 => *t = t.map(|p| p.map(|x| 100.0 * x)),
                _ => {}
            }
        }
        check_leaf(&soup(&corners), Lattice { voxel }, Ijk(far.map(|x| 8 * (x / 4))), &shares(4));
    }
}

#[test]
fn lists_are_kept_by_block() {
    let push = |lists: &mut BlockLists, origin: [i32; 3], slots: &[u32]| {
        let bound = |&p: &u32| PlaneBound { low: p as f32, direction: [0.6, 0.0, -0.8] };
        let bounds: Vec<PlaneBound> = slots.iter().map(bound).collect();
        lists.push(Ijk(origin), slots.iter().copied().map(TriangleSlot), &bounds);
    };
    let mut lists = BlockLists::default();
    lists.begin_leaf();
    push(&mut lists, [0, 0, 0], &[3, 2]);
    push(&mut lists, [0, 0, 2], &[6, 5]);
    push(&mut lists, [2, 0, 0], &[8]);
    push(&mut lists, [4, 0, 0], &[7]);
    let keep = |nodes: [[i32; 3]; 2]| nodes.iter().fold(0, |mask, &n| mask | 1 << block_in_leaf(Ijk(n)));
    lists.retain_blocks(keep([[0, 0, 2], [4, 0, 0]]));
    lists.begin_leaf();
    push(&mut lists, [8, 0, 0], &[9]);
    lists.drop_leaf();
    lists.begin_leaf();
    push(&mut lists, [8, 2, 0], &[4, 1]);
    push(&mut lists, [8, 2, 2], &[0]);
    lists.retain_blocks(keep([[8, 2, 2], [8, 6, 6]]));
    let mut others = BlockLists::default();
    others.begin_leaf();
    push(&mut others, [30, 6, 6], &[1, 2, 3]);
    let parts = [(vec![Ijk([0, 0, 0]), Ijk([8, 0, 0])], lists), (vec![Ijk([24, 0, 0])], others)];
    let lists = CandidateLists::new(Lattice { voxel: 0.5 }, parts);
    let named = |near: Option<Candidates>| -> Option<Vec<u32>> {
        near.map(|near| near.slots.iter().map(|slot| slot.0).collect())
    };
    assert_eq!(named(lists.of_cell(Ijk([1, 1, 3]))), Some(vec![6, 5]));
    assert_eq!(named(lists.of_cell(Ijk([5, 0, 1]))), Some(vec![7]));
    assert_eq!(named(lists.of_cell(Ijk([31, 7, 7]))), Some(vec![1, 2, 3]));
    assert_eq!(named(lists.of_cell(Ijk([0, 0, 0]))), None);
    assert_eq!(named(lists.of_cell(Ijk([2, 0, 0]))), None);
    assert_eq!(named(lists.of_cell(Ijk([8, 0, 0]))), None);
    assert_eq!(named(lists.of_cell(Ijk([8, 2, 0]))), None);
    assert_eq!(named(lists.of_cell(Ijk([9, 2, 3]))), Some(vec![0]));
    assert_eq!(named(lists.at([0.7, 0.6, 1.9])), Some(vec![6, 5]));
    assert_eq!(named(lists.at([f64::NAN, 0.0, f64::INFINITY])), None);
}

#[test]
fn all_seven_regions_of_a_triangle() {
    let mesh =
        soup(&[[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]], [[9.0; 3], [9.0, 9.0, 8.0], [9.0, 8.0, 9.0]]]);
    for origin in [[0, 0, 0], [8, 0, 8], [-16, 8, 0], [-16, -16, 8], [16, -8, -8], [0, 16, 0], [8, 8, 0]] {
        check_leaf(&mesh, Lattice { voxel: 0.3 }, Ijk(origin), &shares(3));
    }
}
