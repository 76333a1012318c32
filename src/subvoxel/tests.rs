use super::*;
use crate::distance::SignedDistance;
use crate::mesh::{Topology, TriMesh, shapes};
use crate::offset::{OffsetResult, OffsetSettings, offset};
use crate::quantity::{Length, VoxelSize};
use crate::run::RunSettings;

const VOXEL: f64 = 0.1;

/// Boxes given by their lowest and highest corners.
fn boxes(all: &[[[f64; 3]; 2]]) -> TriMesh {
    let cube = (shapes::by_name("box").unwrap().make)(2);
    let mut mesh = TriMesh { vertices: Vec::new(), triangles: Vec::new() };
    for [lo, hi] in all {
        let first = mesh.vertices.len() as u32;
        // The shape reaches from -1 to 1.
        let place = |p: &[f64; 3]| std::array::from_fn(|a| lo[a] + 0.5 * (p[a] + 1.0) * (hi[a] - lo[a]));
        mesh.vertices.extend(cube.vertices.iter().map(place));
        mesh.triangles.extend(cube.triangles.iter().map(|t| t.map(|v| first + v)));
    }
    mesh
}

fn run(mesh: &TriMesh, r: f64, max_halvings: u32) -> OffsetResult {
    let settings = OffsetSettings {
        distance: Length::Units(r),
        voxel: VoxelSize::Units(VOXEL),
        max_halvings,
        ..OffsetSettings::default()
    };
    offset(mesh, &settings, &RunSettings::with_threads(2).unwrap()).unwrap()
}

/// Two slabs above each other with `gap` between them, the middle of it at height `z`.
fn slabs(gap: f64, z: f64) -> TriMesh {
    let (low, high) = (z - 0.5 * gap, z + 0.5 * gap);
    boxes(&[[[-0.73, -0.61, low - 0.8], [0.71, 0.67, low]], [[-0.73, -0.61, high], [0.71, 0.67, high + 0.8]]])
}

#[test]
fn a_gap_between_nodes_is_found() {
    for z in [0.03, 0.05, 0.07, -1.34] {
        // What is left of the gap is 0.3 voxels wide.
        let missed = run(&slabs(0.43, z), 0.2, 0).statistics.missed;
        assert!(missed.gaps == 1 && missed.sheets == 0, "{z}: {missed:?}");
        let feature = &missed.features[0];
        assert_eq!(feature.kind, MissedKind::Gap);
        // It widens towards the rounded rims.
        assert!((feature.at[2] - z).abs() < 0.02 && (0.14..0.5).contains(&feature.depth), "{z}: {feature:?}");
        let [lo, hi] = feature.bbox;
        assert!(hi[0] - lo[0] > 1.2 && hi[1] - lo[1] > 1.0, "{feature:?}");
    }
}

#[test]
fn a_sheet_between_nodes_is_found() {
    for z in [0.03, 0.05, 0.07] {
        // A thick block, of which something stays, and a plate that shrinks to 0.3 voxels.
        let mesh = boxes(&[
            [[-3.0, -0.6, -0.6], [-1.0, 0.6, 0.6]],
            [[-0.7, -0.6, z - 0.215], [0.7, 0.6, z + 0.215]],
        ]);
        let missed = run(&mesh, -0.2, 0).statistics.missed;
        assert!(missed.sheets == 1 && missed.gaps == 0, "{z}: {missed:?}");
        assert!((missed.features[0].at[2] - z).abs() < 0.015, "{missed:?}");
    }
}

#[test]
fn a_part_in_a_cell_is_found() {
    for centre in [[1.05, 0.05, 0.05], [1.04, 0.06, 0.04], [1.25, -0.35, 0.55]] {
        let half = 0.025;
        let small = [centre.map(|x| x - half), centre.map(|x| x + half)];
        let mesh = boxes(&[[[-0.6; 3], [0.6; 3]], small]);
        let missed = run(&mesh, 0.0, 0).statistics.missed;
        assert_eq!((missed.parts, missed.count()), (1, 1), "{centre:?}: {missed:?}");
        let at = missed.features[0].at;
        assert!((0..3).all(|a| (at[a] - centre[a]).abs() < half), "{at:?} {centre:?}");
    }
}

#[test]
fn what_is_seen_is_not_reported() {
    let sphere = (shapes::by_name("sphere").unwrap().make)(12);
    let torus = (shapes::by_name("torus").unwrap().make)(12);
    for mesh in [&sphere, &torus, &slabs(0.9, 0.05)] {
        for r in [0.2, 0.07, 0.0] {
            let missed = run(mesh, r, 0).statistics.missed;
            assert_eq!(missed, MissedFeatures::default(), "{r}");
        }
    }
}

/// Each feature against the true distance and against the result.
#[test]
fn every_feature_is_on_the_wrong_side() {
    let mut checked = 0;
    for (name, detail) in
        [("carved_cube", 10), ("fin", 6), ("near_spheres", 12), ("flower", 8), ("bracket", 6)]
    {
        let mesh = (shapes::by_name(name).unwrap().make)(detail);
        let topology = Topology::new(&mesh);
        let truth = SignedDistance::new(&mesh, &topology);
        for r in [0.2, 0.13, 0.0, -0.12, -0.2] {
            let settings = OffsetSettings {
                distance: Length::Units(r),
                voxel: VoxelSize::Units(VOXEL),
                ..OffsetSettings::default()
            };
            let Ok(result) = offset(&mesh, &settings, &RunSettings::with_threads(2).unwrap()) else {
                continue;
            };
            let result_topology = Topology::new(&result.mesh);
            let made = SignedDistance::new(&result.mesh, &result_topology);
            for feature in &result.statistics.missed.features {
                let [true_phi, made_phi] =
                    [truth.at(feature.at.into(), 0).distance - r, made.at(feature.at.into(), 0).distance];
                assert!(true_phi * made_phi < 0.0, "{name} {r}: {feature:?} {true_phi} {made_phi}");
                assert!(made_phi.abs() > 0.04 * VOXEL, "{name} {r}: {feature:?} {made_phi}");
                assert!((true_phi.abs() / VOXEL - feature.depth).abs() < 1e-6);
                checked += 1;
            }
        }
    }
    assert!(checked > 5, "{checked}");
}

#[test]
fn threads_do_not_matter() {
    let mesh = (shapes::by_name("carved_cube").unwrap().make)(10);
    let settings = OffsetSettings {
        distance: Length::Units(-0.2),
        voxel: VoxelSize::Units(0.15),
        ..OffsetSettings::default()
    };
    let [one, two] = [1, 2].map(|threads| {
        offset(&mesh, &settings, &RunSettings::with_threads(threads).unwrap()).unwrap().statistics.missed
    });
    assert_eq!(one, two);
}

#[test]
fn resolving_brings_it_back() {
    let mesh = slabs(0.43, 0.05);
    let [coarse, fine] = [0, 3].map(|max_halvings| run(&mesh, 0.2, max_halvings));
    assert_eq!((coarse.statistics.halvings, coarse.statistics.missed.gaps), (0, 1));
    assert!((1..=3).contains(&fine.statistics.halvings), "{}", fine.statistics.halvings);
    assert_eq!(fine.statistics.missed, MissedFeatures::default());
    assert_eq!(fine.statistics.voxel, VOXEL * 0.5f64.powi(fine.statistics.halvings as i32));
    let components = |result: &OffsetResult| Topology::new(&result.mesh).components();
    assert_eq!((components(&coarse), components(&fine)), (1, 2));
}

#[test]
fn resolving_finds_what_no_node_is_in() {
    // Shrinks to a plate of 0.3 voxels, and to nothing else.
    let mesh = boxes(&[[[-0.7, -0.6, -0.165], [0.7, 0.6, 0.265]]]);
    let settings = OffsetSettings {
        distance: Length::Units(-0.2),
        voxel: VoxelSize::Units(VOXEL),
        max_halvings: 3,
        ..OffsetSettings::default()
    };
    let run = RunSettings::with_threads(2).unwrap();
    let result = offset(&mesh, &settings, &run).unwrap();
    assert!(result.statistics.halvings > 0 && !result.mesh.triangles.is_empty());
    let unresolved = OffsetSettings { max_halvings: 0, ..settings };
    assert!(matches!(offset(&mesh, &unresolved, &run), Err(crate::offset::OffsetError::Empty(_))));
}
