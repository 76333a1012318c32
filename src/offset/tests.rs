//! The whole way, against closed forms and brute force.

mod simd;

use super::*;
use crate::band::NearTriangles;
use crate::band::narrow_band::{self, NarrowBand};
use crate::distance::SignedDistance;
use crate::edge::{EdgeNumbers, EdgeSettings, RootMethod, solve, solve_by};
use crate::lattice::Slab;
use crate::mesh::{Topology, TriMesh};
use crate::mesh::{measure, shapes};
use crate::quantity::{Length, Precision, Tolerance, VoxelSize};
use crate::run::{Cancelled, RunSettings};
use crate::verify::tests::audit::audit;
use glam::DVec3;
use std::f64::consts::PI;

fn run(threads: usize) -> RunSettings {
    RunSettings::with_threads(threads).unwrap()
}

fn settings(distance: f64, voxel: f64) -> OffsetSettings {
    OffsetSettings {
        distance: Length::Units(distance),
        voxel: VoxelSize::Units(voxel),
        precision: Precision::F64,
        ..OffsetSettings::default()
    }
}

fn rotated(mut mesh: TriMesh) -> TriMesh {
    let rotation = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    for v in &mut mesh.vertices {
        *v = (rotation * DVec3::from(*v) + DVec3::new(0.013, -0.021, 0.007)).to_array();
    }
    mesh
}

#[test]
fn a_box_shrunk_is_a_box_with_exact_corners() {
    // Half-side 1 less 0.237: the faces are not on the lattice of 0.1.
    let result = offset(&shapes::cube(1), &settings(-0.237, 0.1), &run(2)).unwrap();
    assert!(audit(&result.mesh).is_sound());
    for n in 0..8 {
        let corner = DVec3::from([0, 1, 2].map(|a| if n >> a & 1 == 1 { 0.763 } else { -0.763 }));
        let nearest = result.mesh.vertices.iter().map(|&v| (DVec3::from(v) - corner).length());
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-6 * 0.1, "corner {corner} is missed by {nearest}");
    }
    // No vertex is off the box, so with the corners its volume is that of the box.
    let volume = measure::signed_volume(&result.mesh);
    assert!((volume - (2.0 * 0.763f64).powi(3)).abs() < 1e-6, "{volume}");
}

/// Errors of volume and area of the grown cube of side 2 against Steiner's formulas.
fn steiner_errors(r: f64, voxel: f64) -> [f64; 2] {
    let result = offset(&rotated(shapes::cube(1)), &settings(r, voxel), &run(2)).unwrap();
    assert!(audit(&result.mesh).is_sound());
    // Volume 8, area 24, and edges of total length 24 with a quarter turn each.
    let volume = 8.0 + 24.0 * r + 6.0 * PI * r * r + 4.0 / 3.0 * PI * r.powi(3);
    let area = 24.0 + 12.0 * PI * r + 4.0 * PI * r * r;
    let relative = |measured: f64, exact: f64| (measured / exact - 1.0).abs();
    [relative(measure::signed_volume(&result.mesh), volume), relative(measure::area(&result.mesh), area)]
}

#[test]
fn a_dilated_cube_converges_to_steiners_formulas_at_second_order() {
    // At radii below 8 voxels, vertices that are high above curved parts are taken down: the error
    // is smaller there.
    let [coarse, fine] = [0.05, 0.025].map(|voxel| steiner_errors(0.5, voxel));
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        assert!(fine < 2e-3, "{fine}");
        // Halving h divides the error by four; 3 leaves room for higher orders.
        assert!(coarse / fine > 3.0, "{coarse} {fine}");
    }
}

#[test]
fn crossings_lie_on_the_offset_surface_by_brute_force() {
    let mesh = shapes::carved_cube(6);
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    for r in [0.11, -0.07, 0.0] {
        let band_settings = settings(r, 0.08).in_model_units(&mesh).unwrap();
        let NarrowBand { signs, near, .. } =
            narrow_band::build::<Cancelled>(&distance, &band_settings, None, &run(2)).unwrap();
        let numbers = EdgeNumbers::new(&signs).unwrap();
        let lattice = band_settings.lattice;
        let (crossings, statistics) = solve(&distance, lattice, r, &signs, numbers, &near, &run(2)).unwrap();
        let solved: u64 = statistics.by_subdivision.iter().sum::<u64>() + statistics.bisected;
        assert_eq!((statistics.intersected, statistics.sign_jumps), (solved, 0));
        let mut checked = 0;
        for leaf in signs.leaves() {
            for (axis, number) in crossings.numbers.in_leaf(leaf) {
                let sample = crossings.sample(crossings.numbers.get(leaf, axis, number).unwrap());
                let node = crate::lattice::Ijk::in_leaf(signs.origin(leaf), number);
                let mut p = DVec3::from(lattice.world_from_index(node));
                p[axis as usize] += sample.t * lattice.voxel;
                let nearest = (0..mesh.triangles.len() as u32)
                    .map(|t| distance.ssvh().triangle(t).distance_squared(p))
                    .fold(f64::INFINITY, f64::min)
                    .sqrt();
                assert!((nearest - r.abs()).abs() <= 1e-6 * lattice.voxel, "{p} {nearest} {r}");
                let length = DVec3::from(sample.normal.map(f64::from)).length();
                assert!((length - 1.0).abs() < 1e-6);
                checked += 1;
            }
        }
        assert!(checked > 1000, "{checked}");
    }
}

#[test]
fn lists_give_the_roots_of_the_hierarchy() {
    for (mesh, voxel) in [(shapes::carved_cube(6), 0.05), (shapes::carved_cube(40), 0.03)] {
        let topology = Topology::new(&mesh);
        let distance = SignedDistance::new(&mesh, &topology);
        for r in [0.11, -0.07, 0.0] {
            let band_settings = settings(r, voxel).in_model_units(&mesh).unwrap();
            let NarrowBand { signs, near, .. } =
                narrow_band::build::<Cancelled>(&distance, &band_settings, None, &run(2)).unwrap();
            let numbers = EdgeNumbers::new(&signs).unwrap();
            let solve = |lists| {
                let near = NearTriangles { nodes: near.nodes.clone(), lists };
                solve(&distance, band_settings.lattice, r, &signs, numbers.clone(), &near, &run(2)).unwrap()
            };
            let (by_lists, counts) = solve(near.lists.clone());
            let (by_queries, expected) = solve(None);
            assert!(by_lists.samples.len() > 1000);
            assert_eq!(by_lists.samples, by_queries.samples, "{r}");
            assert_eq!(counts, expected);
        }
    }
}

#[test]
fn plain_bisection_finds_the_roots_of_the_hybrid_method() {
    let mesh = shapes::carved_cube(6);
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    for r in [0.11, -0.07] {
        let band_settings = settings(r, 0.05).in_model_units(&mesh).unwrap();
        let NarrowBand { signs, near, .. } =
            narrow_band::build::<Cancelled>(&distance, &band_settings, None, &run(2)).unwrap();
        let numbers = EdgeNumbers::new(&signs).unwrap();
        let solve = |method| {
            let lattice = band_settings.lattice;
            let settings = EdgeSettings { lattice, r, method, slab: Slab::WHOLE };
            solve_by(&distance, &settings, &signs, numbers.clone(), &near, &run(2)).unwrap()
        };
        let (hybrid, with_closed_forms) = solve(RootMethod::Hybrid);
        let (plain, halved) = solve(RootMethod::PLAIN_BISECTION);
        let edges = signs.leaves().flat_map(|leaf| hybrid.numbers.in_leaf(leaf).collect::<Vec<_>>());
        let mut other_roots = 0;
        for (((axis, _), a), b) in edges.zip(&hybrid.samples).zip(&plain.samples) {
            // Along an edge that grazes the surface the distance changes slowly, and the root is
            // vague.
            let slope = f64::from(a.normal[axis as usize].abs());
            // An edge may have three roots; each method finds one.
            other_roots += usize::from((a.t - b.t).abs() * slope > 1e-6);
        }
        assert!(hybrid.samples.len() > 1000);
        assert!(1000 * other_roots < hybrid.samples.len(), "{other_roots} of {}", hybrid.samples.len());
        let solved = halved.by_subdivision.iter().sum::<u64>() + halved.bisected;
        assert_eq!((halved.intersected, solved), (with_closed_forms.intersected, halved.intersected));
        assert!(halved.queries > 5 * with_closed_forms.queries, "{halved:?} {with_closed_forms:?}");
        assert!(halved.by_subdivision.iter().sum::<u64>() < halved.intersected / 10);
    }
}

#[test]
fn every_closed_model_gives_a_clean_mesh() {
    for shape in shapes::ALL.iter().filter(|s| s.volume.is_some()) {
        let mesh = (shape.make)(4);
        // Nowhere is so little left that the lattice does not see it.
        for fraction in [0.08, 0.01, 0.0, -0.01] {
            let settings = OffsetSettings {
                distance: Length::DiagonalFraction(fraction),
                voxel: VoxelSize::Resolution(40),
                ..OffsetSettings::default()
            };
            let result = offset(&mesh, &settings, &run(2));
            let result = result.unwrap_or_else(|error| panic!("{} {fraction}: {error}", shape.name));
            assert!(result.statistics.contour.triangles > 100, "{}", shape.name);
            let audit = audit(&result.mesh);
            assert!(audit.is_sound(), "{} {fraction}: {audit:?}", shape.name);
        }
    }
}

#[test]
fn zero_distance_keeps_a_box_sharp() {
    let mesh = rotated(shapes::cube(1));
    let result = offset(&mesh, &settings(0.0, 0.1), &run(2)).unwrap();
    assert!(audit(&result.mesh).is_sound());
    let topology = Topology::new(&mesh);
    let distance = SignedDistance::new(&mesh, &topology);
    let errors = result.mesh.vertices.iter().map(|&v| distance.at(v.into(), 0).distance.abs() / 0.1);
    let errors: Vec<f64> = errors.collect();
    // A dozen vertices at the margin of their cells cut an edge of the box, by 0.009 voxels at
    // most.
    let beside = errors.iter().filter(|&&e| e > 1e-6).count();
    assert!(1000 * beside < 5 * errors.len(), "{beside} of {}", errors.len());
    let largest = errors.iter().copied().fold(0.0, f64::max);
    assert!(largest < 0.02, "{largest} voxels");
}

#[test]
fn the_same_result_for_every_number_of_threads() {
    let mesh = shapes::flower(8);
    let results = [1, 2, 8].map(|threads| offset(&mesh, &settings(0.05, 0.04), &run(threads)).unwrap());
    assert_eq!(results[0].mesh, results[1].mesh);
    assert_eq!(results[0].mesh, results[2].mesh);
    assert_eq!(results[0].statistics.edges, results[2].statistics.edges);
    assert_eq!(results[0].statistics.filter, results[2].statistics.filter);
}

#[test]
fn a_grown_offset_has_a_larger_volume() {
    let mesh = shapes::anchor(6);
    let volumes = [-0.05, -0.02, 0.0, 0.03, 0.1]
        .map(|r| measure::signed_volume(&offset(&mesh, &settings(r, 0.04), &run(2)).unwrap().mesh));
    assert!(volumes.is_sorted(), "{volumes:?}");
}

#[test]
fn an_open_mesh_is_refused_with_its_first_boundary_edge() {
    let mesh = shapes::wave(4);
    let error = offset(&mesh, &settings(0.1, 0.1), &run(1)).unwrap_err();
    let OffsetError::Input(InputError::Open { count, .. }) = &error else { panic!("{error}") };
    assert!(*count > 0);
    assert!(error.to_string().contains("boundary edges"), "{error}");

    let mut twisted = shapes::cube(1);
    twisted.triangles[0].swap(0, 1);
    let error = offset(&twisted, &settings(0.1, 0.1), &run(1)).unwrap_err();
    assert!(matches!(error, OffsetError::Input(InputError::Misoriented { count: 3, .. })), "{error}");
    let error = offset(&TriMesh::default(), &settings(0.1, 0.1), &run(1)).unwrap_err();
    assert!(matches!(error, OffsetError::Input(InputError::NoTriangles)), "{error}");
}

#[test]
fn an_open_mesh_goes_ahead_by_pseudonormals_and_is_closed_at_jumps() {
    // A sphere with a hole much wider than the shrink: the sign jumps inside, far from the surface.
    let mut mesh = shapes::sphere(6);
    let z = |t: &[u32; 3]| t.iter().map(|&v| mesh.vertices[v as usize][2]).sum::<f64>() / 3.0;
    let kept: Vec<[u32; 3]> = mesh.triangles.iter().copied().filter(|t| z(t) < 0.6).collect();
    mesh.triangles = kept;
    let mut jumps = 0;
    for r in [-0.1, 0.1, 0.0] {
        let settings = OffsetSettings { open_input: OpenInput::Accept, ..settings(r, 0.05) };
        let result = offset(&mesh, &settings, &run(2)).unwrap();
        let audit = audit(&result.mesh);
        assert!(audit.is_sound(), "{r}: {audit:?}");
        jumps += result.statistics.edges.sign_jumps;
    }
    assert!(jumps > 0, "the hole must have been closed somewhere");
}

#[test]
fn a_closed_mesh_that_intersects_itself_is_closed_at_jumps() {
    // Two cubes in one mesh: inside one of them, beside the other's faces, pseudonormals say
    // outside, and half-way to the first one's faces the sign jumps, far from the surface.
    let mut mesh = shapes::cube(1);
    let other = shapes::cube(1);
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(other.vertices.iter().map(|v| [v[0] + 0.9, v[1] + 0.3, v[2] + 0.2]));
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    let result = offset(&mesh, &settings(0.03, 0.02), &run(2)).unwrap();
    assert!(result.statistics.edges.sign_jumps > 0);
    assert!(audit(&result.mesh).is_sound());
}

#[test]
fn the_two_sides_of_a_sheet_have_no_inside() {
    let mut mesh = shapes::cube(2);
    let other_side: Vec<[u32; 3]> = mesh.triangles.iter().map(|&[a, b, c]| [c, b, a]).collect();
    mesh.triangles.extend(other_side);
    for open_input in [OpenInput::Refuse, OpenInput::Accept] {
        let error = offset(&mesh, &OffsetSettings { open_input, ..settings(0.1, 0.1) }, &run(1)).unwrap_err();
        assert!(matches!(error, OffsetError::Input(InputError::Doubled { .. })), "{error}");
    }
    // One side more is a solid again, though edges have three triangles.
    mesh.triangles.extend(shapes::cube(2).triangles);
    let result = offset(&mesh, &settings(0.1, 0.1), &run(1));
    assert!(!matches!(result, Err(OffsetError::Input(InputError::Doubled { .. }))));
}

#[test]
fn shrinking_beyond_everything_names_the_depth() {
    let error = offset(&shapes::cube(1), &settings(-1.5, 0.1), &run(1)).unwrap_err();
    let OffsetError::Empty(EmptyResult::TooDeep { depth, .. }) = error else { panic!("{error}") };
    assert!((depth - 1.0).abs() < 2e-3, "{depth}");
    // Something is left, a cube of side 0.02, but it slips between the nodes.
    let mut mesh = shapes::cube(1);
    for v in mesh.vertices.as_flattened_mut() {
        *v += 0.17;
    }
    let error = offset(&mesh, &settings(-0.99, 0.34), &run(1)).unwrap_err();
    assert!(matches!(error, OffsetError::Empty(EmptyResult::TooThin { .. })), "{error}");
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    let mesh = shapes::cube(1);
    for wrong in [
        settings(f64::NAN, 0.1),
        settings(0.1, 0.0),
        settings(0.1, -1.0),
        settings(0.1, f64::INFINITY),
        settings(0.1, 1e-12),
        OffsetSettings { band: Some(BandOptions { half_width: 0.5, closest: false }), ..settings(0.1, 0.1) },
        OffsetSettings { voxel: VoxelSize::Resolution(0), ..settings(0.1, 0.1) },
    ] {
        let error = offset(&mesh, &wrong, &run(1)).unwrap_err();
        assert!(matches!(error, OffsetError::Settings(_)), "{wrong:?}: {error}");
    }
}

#[test]
fn a_tolerance_that_coordinates_cannot_keep_is_refused_with_one_that_they_can() {
    let with =
        |tolerance, precision| OffsetSettings { tolerance: Some(tolerance), precision, ..settings(0.1, 0.5) };
    for (precision, bits) in [(Precision::F32, 32), (Precision::F64, 64)] {
        let mut mesh = shapes::cube(1);
        for tolerance in [Tolerance::Units(1e-300), Tolerance::Voxels(1e-300)] {
            let error = offset(&mesh, &with(tolerance, precision), &run(1)).unwrap_err();
            let OffsetError::Settings(SettingsError::FineTolerance { bits: found, smallest, .. }) = error
            else {
                panic!("{error}")
            };
            assert_eq!(found, bits);
            // What is taken makes a mesh like any other.
            let fine = offset(&mesh, &with(Tolerance::Units(smallest), precision), &run(1)).unwrap();
            assert!(fine.statistics.contour.beyond_tolerance.is_some());
            // Farther from the origin, it would be larger.
            mesh.vertices.iter_mut().for_each(|v| v[0] += 8.0);
            let error = offset(&mesh, &with(Tolerance::Units(smallest), precision), &run(1)).unwrap_err();
            assert!(matches!(error, OffsetError::Settings(SettingsError::FineTolerance { .. })), "{error}");
        }
    }
}

#[test]
fn a_voxel_size_beyond_memory_is_refused_with_one_that_fits() {
    let limited = |voxel| OffsetSettings { max_memory: Some(64 << 20), ..settings(0.1, voxel) };
    let error = offset(&shapes::cube(1), &limited(0.001), &run(1)).unwrap_err();
    let OffsetError::Memory(MemoryError { needed, allowed, smallest_voxel, .. }) = error else {
        panic!("{error}")
    };
    assert!(needed > allowed && smallest_voxel > 0.001);
    assert!(offset(&shapes::cube(1), &limited(smallest_voxel * 1.01), &run(2)).is_ok());
}
