//! Grids in memory.

use crate::sphere::{Sphere, read_out};
use exocarp::internals::lattice::{Ijk, Lattice};
use exocarp::internals::vdb::write;
use exocarp::vdb::{SurfaceGrid, VdbError, VdbOptions};
use exocarp::{CancelToken, RunSettings};

const SPHERE: Sphere = Sphere { radius: 1.0, voxel: 1.0 / 30.0, half_width: 3.0 };

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

#[test]
fn leaves_come_out_as_they_went_in() {
    let band = SPHERE.band();
    let (leaves, _) = SPHERE.leaves(band.surface.background());
    assert_eq!(band.surface.leaf_count(), leaves.origins.len());
    let active: u32 = leaves.active.iter().flatten().map(|w| w.count_ones()).sum();
    assert_eq!(band.surface.active_voxels(), u64::from(active));
    // 2 KiB of values per leaf, and two inner nodes in each octant around the origin, 300 KB
    // together.
    let values = 4 * leaves.values.len() as u64;
    let memory = band.surface.memory();
    assert!((values..values * 11 / 10 + 8 * 300_000).contains(&memory), "{memory}");
    let out = read_out(&band);
    let sorted = leaves.sorted();
    assert!(out.values.iter().map(|v| v.to_bits()).eq(sorted.values.iter().map(|v| v.to_bits())));
    assert_eq!(out, sorted);
}

#[test]
fn a_sphere_passes_the_nine_tests_of_openvdb() {
    for voxel in [1.0 / 30.0, 0.1, 0.07, 1.0 / 3.0] {
        let sphere = Sphere { voxel, radius: 20.0 * voxel, half_width: 3.0 };
        let messages = sphere.band().surface.check_level_set(&run()).unwrap();
        assert!(messages.is_empty(), "h = {voxel}: {messages:?}");
    }
}

#[test]
fn the_nine_tests_of_openvdb_find_what_is_wrong() {
    let narrow = Sphere { half_width: 1.0, ..SPHERE }.band();
    let messages = narrow.surface.check_level_set(&run()).unwrap();
    assert!(messages[0].starts_with("test 4: The background value"), "{messages:?}");
    assert!(!messages[0].contains('\n'));

    // Distances of half their size: the gradient is one half.
    let mut flat = SurfaceGrid::new(SPHERE.lattice(), 3.0).unwrap();
    let (mut leaves, _) = SPHERE.leaves(flat.background());
    leaves.values.iter_mut().filter(|v| v.abs() < flat.background()).for_each(|v| *v *= 0.5);
    flat.insert_leaves(&leaves.origins, &leaves.values, &leaves.active).unwrap();
    let messages = flat.check_level_set(&run()).unwrap();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].starts_with("test 9: "), "{messages:?}");
}

#[test]
fn voxels_too_small_for_a_transform_stay_in_memory() {
    let tiny = Sphere { radius: 1e-6, voxel: 1e-7, half_width: 3.0 };
    let band = tiny.band();
    assert_eq!(read_out(&band), tiny.leaves(band.surface.background()).0.sorted());
    assert_eq!(band.surface.lattice(), tiny.lattice());
    assert!(matches!(band.surface.check_level_set(&run()), Err(VdbError::Size { .. })));
    let path = tempfile::NamedTempFile::new().unwrap();
    let error = write(path.path(), &band.surface, None, &VdbOptions::default()).unwrap_err();
    assert!(error.to_string().ends_with("voxel size of at least 1.5e-5; scale the model up"), "{error}");
}

#[test]
fn a_cancelled_run_stops_the_tests() {
    let token = CancelToken::default();
    token.cancel();
    let error = SPHERE.band().surface.check_level_set(&run().with_cancel(token)).unwrap_err();
    assert!(matches!(error, VdbError::Cancelled));
}

#[test]
fn inside_is_known_everywhere() {
    let surface = SPHERE.band().surface;
    let nodes: Vec<Ijk> = (-60..60).flat_map(|i| (-60..60).map(move |k| Ijk::new(i, 7, k))).collect();
    for (node, inside) in nodes.iter().zip(surface.inside_at(&nodes)) {
        assert_eq!(inside, SPHERE.phi(*node) < 0.0, "{node:?}");
    }
    let far = [Ijk::new(0, 0, 0), Ijk::new(1_000_000, -5, 3), Ijk::new(i32::MIN, 0, i32::MAX)];
    assert_eq!(surface.inside_at(&far), [true, false, false]);
}

#[test]
fn blocks_become_the_largest_tiles_that_fit() {
    let mut grid = SurfaceGrid::new(Lattice { voxel: 1.0 }, 3.0).unwrap();
    let empty = grid.memory();
    // Aligned to 128, not aligned to 128, and larger than a node of the tree's lowest level.
    let blocks = [(Ijk::new(128, 0, 0), 128), (Ijk::new(-1000, 8, 0), 128), (Ijk::new(4096, 0, -4096), 512)];
    let origins = blocks.map(|(origin, _)| origin);
    grid.fill_inside(&origins, &blocks.map(|(_, side)| side)).unwrap();
    grid.prune();
    assert_eq!((grid.leaf_count(), grid.active_voxels()), (0, 0));
    for (origin, side) in blocks {
        let last = Ijk(origin.0.map(|x| x + side as i32 - 1));
        let before = Ijk(origin.0.map(|x| x - 1));
        let after = Ijk(origin.0.map(|x| x + side as i32));
        assert_eq!(grid.inside_at(&[origin, last, before, after]), [true, true, false, false]);
    }
    // One tile each of the aligned blocks; as leaves they would take hundreds of megabytes.
    assert!(grid.memory() - empty < 2_000_000, "{}", grid.memory());
}

#[test]
fn many_small_blocks_merge_upward() {
    let cells: Vec<Ijk> = (0..4096).map(|n| Ijk::new(n / 256 * 8, n / 16 % 16 * 8, n % 16 * 8)).collect();
    let fill = || {
        let mut grid = SurfaceGrid::new(Lattice { voxel: 1.0 }, 3.0).unwrap();
        grid.fill_inside(&cells, &[8; 4096]).unwrap();
        grid
    };
    let mut pruned = fill();
    pruned.prune();
    assert!(pruned.memory() + 4096 * 4 < fill().memory());
    assert_eq!(pruned.inside_at(&[Ijk::new(127, 127, 127), Ijk::new(128, 0, 0)]), [true, false]);
}

#[test]
fn a_leaf_is_replaced_and_a_block_drops_it() {
    let mut grid = SurfaceGrid::new(Lattice { voxel: 1.0 }, 3.0).unwrap();
    let origin = Ijk::new(-8, 16, 0);
    for value in [1.0_f32, -2.0] {
        grid.insert_leaves(&[origin], &[value; 512], &[[!0; 8]]).unwrap();
        let (mut values, mut active) = (vec![0.0; 512], [[0; 8]]);
        grid.read_leaves(0, &mut values, &mut active).unwrap();
        assert_eq!((grid.leaf_count(), values, active), (1, vec![value; 512], [[!0; 8]]));
    }
    grid.fill_inside(&[origin], &[8]).unwrap();
    assert_eq!((grid.leaf_count(), grid.inside_at(&[origin])), (0, vec![true]));
}

#[test]
fn grids_can_be_read_from_several_threads() {
    let band = SPHERE.band();
    let expected = read_out(&band);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(read_out(&band), expected));
        }
    });
}
