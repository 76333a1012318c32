use super::*;
use crate::candidates::CandidateLists;
use crate::distance::SignedDistance;
use crate::filter::{BoxSide, FilterSettings, Switch};
use crate::geom::aabb::Aabb;
use crate::lattice::{Ijk, LEAF_SIZE, Lattice, Slab};
use crate::mesh::{Topology, TriMesh};
use crate::run::{Cancelled, RunSettings};
use glam::DVec3;
use std::collections::HashMap;

/// Returns an octahedron of circumradius 1 around a centre off the lattice.
fn octahedron() -> TriMesh {
    let c = [0.03, -0.01, 0.02];
    let vertex =
        |axis: usize, s: f64| -> [f64; 3] { std::array::from_fn(|a| c[a] + if a == axis { s } else { 0.0 }) };
    let vertices = vec![
        vertex(0, 1.0),
        vertex(0, -1.0),
        vertex(1, 1.0),
        vertex(1, -1.0),
        vertex(2, 1.0),
        vertex(2, -1.0),
    ];
    let triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    TriMesh { vertices, triangles }
}

fn build_all(settings: &BandSettings, threads: usize) -> LeafBatch {
    let mesh = octahedron();
    let topology = Topology::new(&mesh);
    assert!(topology.defects().is_closed());
    let distance = SignedDistance::new(&mesh, &topology);
    let run = RunSettings::with_threads(threads).unwrap();
    let mut all = LeafBatch::default();
    build(&distance, settings, &run, |batch| {
        all.origins.extend(batch.origins);
        all.values.extend(batch.values);
        all.active.extend(batch.active);
        all.closest.extend(batch.closest);
        all.inside_blocks.extend(batch.inside_blocks);
        Ok::<_, Cancelled>(())
    })
    .unwrap();
    all
}

/// The band against a query at every node of the grid.
fn check_against_every_node(r: f64, half_width: f64) {
    let mesh = octahedron();
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let settings = BandSettings { lattice: Lattice { voxel: 0.07 }, r, half_width, slab: Slab::WHOLE };
    let batch = build_all(&settings, 2);
    let background = settings.background();
    let leaf: HashMap<Ijk, usize> = batch.origins.iter().zip(0..).map(|(&o, n)| (o, n)).collect();
    assert_eq!(leaf.len(), batch.len(), "no leaf twice");
    let covered_inside = |node: Ijk| {
        let inside = |&(o, side): &(Ijk, i32)| (node - o).0.iter().all(|&x| (0..side).contains(&x));
        batch.inside_blocks.iter().filter(|b| inside(b)).count()
    };
    let [lo, hi] =
        grid_nodes(crate::geom::aabb::Aabb::around(mesh.vertices.iter().map(|&v| v.into())), &settings);
    let (mut active, mut inside) = (0, 0);
    for i in lo.0[0]..=hi.0[0] {
        for j in lo.0[1]..=hi.0[1] {
            for k in lo.0[2]..=hi.0[2] {
                let node = Ijk::new(i, j, k);
                let phi = distance.at(settings.lattice.world_from_index(node).into(), 0).distance - r;
                inside += usize::from(phi < 0.0);
                let Some(&n) = leaf.get(&node.leaf_origin()) else {
                    assert!(phi.abs() >= f64::from(background), "{node:?} is missing: {phi}");
                    assert_eq!(covered_inside(node), usize::from(phi < 0.0), "{node:?} {phi}");
                    continue;
                };
                assert_eq!(covered_inside(node), 0, "a leaf under an inside block");
                let number = node.number_in_leaf();
                let value = batch.values[512 * n + number];
                let is_active = batch.active[n][number >> 6] >> (number & 63) & 1 == 1;
                assert_eq!(value < 0.0, phi < 0.0, "{node:?} {value} {phi}");
                assert_eq!(is_active, phi.abs() < f64::from(background), "{node:?}");
                if is_active {
                    assert!((f64::from(value) - phi).abs() <= 2e-7 * f64::from(background));
                    assert!(batch.closest[512 * n + number] >= 0);
                    active += 1;
                } else {
                    assert_eq!(value.abs(), background);
                    assert_eq!(batch.closest[512 * n + number], -1);
                }
            }
        }
    }
    assert!(active > 100 && inside > 10, "{active} {inside}");
}

#[test]
fn the_band_holds_exactly_the_valid_nodes_and_all_signs() {
    for (r, half_width) in [(0.0, 1.0), (0.4, 1.0), (-0.2, 1.0), (0.03, 3.0), (-0.1, 3.0), (2.0, 1.5)] {
        check_against_every_node(r, half_width);
    }
}

#[test]
fn the_band_does_not_depend_on_the_number_of_threads() {
    let settings =
        BandSettings { lattice: Lattice { voxel: 0.05 }, r: 0.2, half_width: 3.0, slab: Slab::WHOLE };
    let one = build_all(&settings, 1);
    for threads in [2, 8] {
        let other = build_all(&settings, threads);
        assert_eq!(one.origins, other.origins);
        assert_eq!(one.values, other.values);
        assert_eq!(one.closest, other.closest);
        assert_eq!(one.inside_blocks, other.inside_blocks);
    }
}

#[test]
fn cancelling_stops_the_band() {
    let mesh = octahedron();
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let run = RunSettings::with_threads(2).unwrap();
    run.cancel_token().cancel();
    let settings =
        BandSettings { lattice: Lattice { voxel: 0.05 }, r: 0.2, half_width: 1.0, slab: Slab::WHOLE };
    assert_eq!(build(&distance, &settings, &run, |_| Ok::<_, Cancelled>(())), Err(Cancelled));
}

#[test]
fn nodes_on_the_offset_surface_are_outside_whatever_rounding_says() {
    let mesh = crate::mesh::shapes::cube(1);
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let lattice = Lattice { voxel: 0.1 };
    // Faces at 1 + 0.3, where 13 * 0.1 is a node; and at 1 - 0.3, where 7 * 0.1 is not 0.7 in f64.
    for (r, plane) in [(0.3, 13), (-0.3, 7)] {
        let settings = BandSettings { lattice, r, half_width: 1.0, slab: Slab::WHOLE };
        let run = RunSettings::with_threads(1).unwrap();
        let (mut on_plane, mut values) = (0, Vec::new());
        build(&distance, &settings, &run, |batch| {
            for (leaf, &origin) in batch.origins.iter().enumerate() {
                for n in 0..LEAF_SIZE {
                    let [i, j, k] = Ijk::in_leaf(origin, n).0;
                    if i.abs() == plane && j.abs() < 6 && k.abs() < 6 {
                        on_plane += 1;
                        values.push(batch.values[leaf * LEAF_SIZE + n]);
                    }
                }
            }
            Ok::<_, Cancelled>(())
        })
        .unwrap();
        assert_eq!(on_plane, 2 * 11 * 11);
        assert!(values.iter().all(|&v| v == f32::MIN_POSITIVE), "{r}: {values:?}");
    }
}

/// Every choice of filters, with boxes of 8 to 32 cells.
fn all_filters() -> Vec<FilterSettings> {
    let switches = [Switch::On, Switch::Off];
    let mut all = Vec::new();
    for side in [BoxSide::Automatic, BoxSide::PowerOfTwo(3), BoxSide::PowerOfTwo(5)] {
        for bounding_box in switches {
            for signed_distance in switches {
                for octree in switches {
                    for candidates in switches {
                        let filters =
                            FilterSettings { side, bounding_box, signed_distance, octree, candidates };
                        all.push(filters);
                    }
                }
            }
        }
    }
    all
}

#[test]
fn the_band_does_not_depend_on_the_filters() {
    let mesh = octahedron();
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let run = RunSettings::with_threads(2).unwrap();
    for (r, half_width) in [(0.3, 1.0), (-0.2, 3.0), (0.0, 1.0)] {
        let settings = BandSettings { lattice: Lattice { voxel: 0.09 }, r, half_width, slab: Slab::WHOLE };
        // Leaves by origin: batches come in the order of the boxes.
        let leaves = |filters: &FilterSettings| {
            let mut leaves = std::collections::BTreeMap::new();
            let mut inside = std::collections::BTreeSet::new();
            let counts = build_filtered(&distance, &settings, filters, &run, |batch| {
                for (n, &origin) in batch.origins.iter().enumerate() {
                    let part = 512 * n..512 * (n + 1);
                    let values = batch.values[part.clone()].to_vec();
                    let leaf = (values, batch.active[n], batch.closest[part].to_vec());
                    assert!(leaves.insert(origin, leaf).is_none(), "{origin:?} comes twice");
                }
                for &(origin, side) in &batch.inside_blocks {
                    inside.extend(crate::filter::Block { origin, width: side }.leaves());
                }
                Ok::<_, Cancelled>(())
            });
            (leaves, inside, counts.unwrap())
        };
        let (expected, inside, _) = leaves(&FilterSettings::default());
        assert!(expected.len() > 20, "{}", expected.len());
        for filters in all_filters() {
            let (found, found_inside, mut counts) = leaves(&filters);
            assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{filters:?}");
            assert!(found == expected, "{filters:?}");
            assert_eq!(found_inside, inside, "{filters:?}");
            let counted = count_queries(&distance, &settings, &filters, &run).unwrap();
            assert!(counts.valid_nodes > 500);
            counts.valid_nodes = 0;
            if filters.candidates == Switch::Off || filters.octree == Switch::Off {
                assert_eq!(counted, counts, "{filters:?}");
            } else {
                // Lists reject by bounds with rounding, and may keep a block more.
                let (lists, queries) = (counts.node_queries, counted.node_queries);
                assert!((queries..queries + queries / 100).contains(&lists), "{lists} {queries} {filters:?}");
                assert!(counts.lists.iter().all(|&n| n > 0));
            }
        }
    }
}

#[test]
fn leaves_with_too_many_candidates_ask_the_hierarchy() {
    let mesh = crate::mesh::shapes::cube(96);
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let run = RunSettings::with_threads(2).unwrap();
    let size = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v))).size().x;
    // All leaves, and some.
    for (voxels, by_lists) in [(12.0, [false, true]), (32.0, [true, true])] {
        let lattice = Lattice { voxel: size / voxels };
        let settings = BandSettings { lattice, r: 0.1 * size, half_width: 1.0, slab: Slab::WHOLE };
        let leaves = |candidates| {
            let filters = FilterSettings { candidates, ..FilterSettings::default() };
            let mut leaves = Vec::new();
            let (mut with, mut without) = (0, 0);
            build_filtered(&distance, &settings, &filters, &run, |batch| {
                let lists = CandidateLists::new(lattice, [(batch.origins.clone(), batch.lists)]);
                for &origin in &batch.origins {
                    let mut nodes = (0..512).map(|n| Ijk::in_leaf(origin, n));
                    let has_lists = nodes.any(|node| lists.of_cell(node).is_some());
                    *(if has_lists { &mut with } else { &mut without }) += 1;
                }
                leaves.push((batch.origins, batch.values, batch.active, batch.closest));
                Ok::<_, Cancelled>(())
            })
            .unwrap();
            (leaves, [with > 0, without > 0])
        };
        let (found, kinds) = leaves(Switch::On);
        assert_eq!(kinds, by_lists, "{voxels}");
        assert!(found == leaves(Switch::Off).0, "{voxels}");
    }
}

#[test]
fn each_filter_saves_distance_computations() {
    let mesh = octahedron();
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let run = RunSettings::with_threads(2).unwrap();
    let settings =
        BandSettings { lattice: Lattice { voxel: 0.02 }, r: 0.3, half_width: 1.0, slab: Slab::WHOLE };
    let count = |signed_distance, octree, n| {
        let side = BoxSide::PowerOfTwo(n);
        let filters = FilterSettings { side, signed_distance, octree, ..FilterSettings::default() };
        count_queries(&distance, &settings, &filters, &run).unwrap().distance_computations()
    };
    use Switch::{Off, On};
    for n in 3..7 {
        let [bb, sd, ot, all] = [(Off, Off), (On, Off), (Off, On), (On, On)].map(|(s, o)| count(s, o, n));
        assert!(all <= ot && ot < bb && all < sd && sd <= bb, "2^{n}: {bb} {sd} {ot} {all}");
    }
    let none = FilterSettings {
        bounding_box: Off,
        signed_distance: Off,
        octree: Off,
        candidates: Off,
        side: BoxSide::PowerOfTwo(4),
    };
    let brute = count_queries(&distance, &settings, &none, &run).unwrap();
    assert!(brute.node_queries >= brute.nodes_total && count(Off, Off, 4) < brute.node_queries);
}
