//! Thickened patches: sound solids that keep their patch.

mod common;

use common::thickened::check;
use exocarp::internals::mesh::Topology;
use exocarp::internals::mesh::measure::{area, signed_volume};
use exocarp::{
    Length, PatchError, PatchSide, RunSettings, SectionNormals, ThickenError, ThickenSettings,
    ThickenSettingsError, TriMesh, VoxelSize, shapes, thicken,
};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

fn settings(thickness: f64, voxel: f64, side: PatchSide) -> ThickenSettings {
    ThickenSettings {
        thickness: Length::Units(thickness),
        voxel: Some(VoxelSize::Units(voxel)),
        side,
        ..ThickenSettings::default()
    }
}

/// A surface over a grid of parameters in 0..=1; `closed` joins its last column to the first.
fn surface(columns: u32, rows: u32, closed: bool, at: impl Fn(f64, f64) -> [f64; 3]) -> TriMesh {
    let width = if closed { columns } else { columns + 1 };
    let share = |i: u32, of: u32| f64::from(i) / f64::from(of);
    let vertices = (0..=rows)
        .flat_map(|j| (0..width).map(move |i| (i, j)))
        .map(|(i, j)| at(share(i, columns), share(j, rows)).map(|x| f64::from(x as f32)))
        .collect();
    let number = |i: u32, j: u32| j * width + i % width;
    let triangles = (0..rows)
        .flat_map(|j| (0..columns).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriMesh { vertices, triangles }
}

fn square(n: u32) -> TriMesh {
    surface(n, n, false, |u, v| [2.0 * u - 1.0, 2.0 * v - 1.0, 0.0])
}

/// Two meshes as one.
fn both(mut a: TriMesh, b: TriMesh) -> TriMesh {
    let first = a.vertices.len() as u32;
    a.vertices.extend(b.vertices);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + first)));
    a
}

#[track_caller]
fn refused(patch: &TriMesh, settings: &ThickenSettings) -> ThickenError {
    match thicken(patch, settings, &run()) {
        Err(error) => error,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_square_becomes_a_plate_of_its_thickness() {
    for (n, side) in [(1, PatchSide::Inner), (8, PatchSide::Outer)] {
        let result = check(&square(n), &settings(0.2, 0.047, side));
        let volume = signed_volume(&result.mesh);
        assert!((volume / 0.8 - 1.0).abs() < 0.005, "{volume}");
        let sign = if side == PatchSide::Inner { -1.0 } else { 1.0 };
        for v in &result.mesh.vertices {
            assert!((-1e-6..0.2 + 1e-6).contains(&(sign * v[2])), "{v:?}");
        }
    }
}

/// Volume of what lies within r of a convex dome on its outer side (or on its inner side) with the
/// closest point off the boundary, by Steiner's formula for polyhedra: area, edges with their outer
/// angles, vertices with their angle defects.
fn steiner(dome: &TriMesh, r: f64, side: PatchSide) -> f64 {
    let topology = Topology::new(dome);
    let corner = |v: u32| glam::DVec3::from(dome.vertices[v as usize]);
    let normal = |t: usize| {
        let [a, b, c] = dome.triangles[t].map(corner);
        (b - a).cross(c - a).normalize()
    };
    let mut edges = 0.0;
    let mut defects = vec![TAU; dome.vertices.len()];
    for (t, triangle) in dome.triangles.iter().enumerate() {
        for k in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|n| triangle[(k + n) % 3]);
            defects[a as usize] -= (corner(b) - corner(a)).angle_between(corner(c) - corner(a));
            let others = topology.around_vertex(a).iter().map(|&o| o as usize);
            match others.into_iter().find(|&o| o != t && dome.triangles[o].contains(&b)) {
                Some(other) => {
                    // Half of it, since the edge comes once from each side.
                    let half = 0.5 * normal(t).angle_between(normal(other));
                    let turned = if side == PatchSide::Outer { half } else { half.tan() };
                    edges += 0.5 * turned * corner(a).distance(corner(b));
                }
                None => [a, b].iter().for_each(|&v| defects[v as usize] = f64::NAN),
            }
        }
    }
    let vertices: f64 = defects.iter().filter(|d| d.is_finite()).sum();
    let sign = if side == PatchSide::Outer { 1.0 } else { -1.0 };
    area(dome) * r + sign * edges * r * r + vertices * r.powi(3) / 3.0
}

#[test]
fn a_hemisphere_has_the_volume_of_steiner() {
    let dome = surface(48, 12, true, |u, v| {
        let (s, c) = (0.02 + 0.98 * v).mul_add(0.5 * PI, 0.0).sin_cos();
        [s * (TAU * u).cos(), -s * (TAU * u).sin(), c]
    });
    for side in [PatchSide::Inner, PatchSide::Outer] {
        let result = check(&dome, &settings(0.15, 0.05, side));
        let (volume, expected) = (signed_volume(&result.mesh), steiner(&dome, 0.15, side));
        assert!((volume / expected - 1.0).abs() < 0.005, "{side:?}: {volume} {expected}");
    }
}

#[test]
fn shape_processing_sharpens_the_edges_of_the_section() {
    // No edge of the plate is along the lattice.
    let (x, y) = (glam::DVec3::new(0.8, 0.5, 0.3).normalize(), glam::DVec3::new(-0.5, 0.8, 0.0).normalize());
    let tilted = surface(6, 6, false, |u, v| ((2.0 * u - 1.0) * x + (2.0 * v - 1.0) * y).to_array());
    let with = |rounds, section_normals| {
        let processed = ThickenSettings { rounds, section_normals, ..settings(0.3, 0.07, PatchSide::Inner) };
        let result = check(&tilted, &processed);
        let missing = (1.0 - signed_volume(&result.mesh) / (0.3 * area(&tilted))).abs();
        (missing, result.statistics.shape)
    };
    let (before, none) = with(0, SectionNormals::Exact);
    assert_eq!((none.rounds, none.moves), (0, 0));
    let (after, some) = with(100, SectionNormals::Exact);
    assert!(some.moves > 0 && (2..100).contains(&some.rounds), "it stops when nothing moves: {some:?}");
    assert!(after < 0.5 * before, "{after} of the volume, before {before}");
    let (smoothed, _) = with(10, SectionNormals::Smoothed);
    assert!(smoothed < before, "{smoothed} of the volume, before {before}");
}

#[test]
fn surfaces_with_several_loops_and_parts() {
    let saddle = surface(10, 10, false, |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        [x, y, 0.5 * (x * x - y * y)]
    });
    let tube = surface(24, 4, true, |u, v| [3.0 + 0.7 * (TAU * u).cos(), 0.7 * (TAU * u).sin(), v]);
    let ring = surface(24, 4, true, |u, v| {
        let r = 0.5 + 0.5 * v;
        [r * (TAU * u).cos(), r * (TAU * u).sin(), 3.0]
    });
    for side in [PatchSide::Inner, PatchSide::Outer] {
        check(&both(both(saddle.clone(), tube.clone()), ring.clone()), &settings(0.2, 0.06, side));
    }
}

#[test]
fn a_closed_mesh_becomes_a_shell() {
    let cube = (shapes::by_name("box").unwrap().make)(4);
    let whole = signed_volume(&cube);
    let inner = check(&cube, &settings(0.1, 0.04, PatchSide::Inner));
    let outer = check(&cube, &settings(0.1, 0.04, PatchSide::Outer));
    // A wall inward: the cube less a cube.
    let wall = whole - (2.0f64 - 0.2).powi(3);
    assert!((signed_volume(&inner.mesh) / wall - 1.0).abs() < 0.005, "{}", signed_volume(&inner.mesh));
    // Outward by Steiner's formula: slabs, quarters of cylinders, and a ball in eight parts.
    let wall = area(&cube) * 0.1 + 24.0 * PI / 4.0 * 0.01 + 4.0 / 3.0 * PI * 0.001;
    assert!((signed_volume(&outer.mesh) / wall - 1.0).abs() < 0.005, "{}", signed_volume(&outer.mesh));
    // Nothing is left within a wall as thick as the box: it is solid.
    let solid = check(&cube, &settings(10.0, 1.0, PatchSide::Inner));
    assert_eq!(solid.statistics.triangles.new, 0);
}

#[test]
fn parts_that_touch_in_a_vertex_hang_together() {
    // Two opposite quarters of a checkerboard.
    let mut board = square(6);
    let quarter = |t: &[u32; 3]| {
        let [x, y]: [f64; 2] =
            [0, 1].map(|a| t.iter().map(|&v| board.vertices[v as usize][a]).sum::<f64>() / 3.0);
        x * y > 0.0
    };
    let kept = board.triangles.iter().copied().filter(quarter).collect();
    board.triangles = kept;
    for side in [PatchSide::Inner, PatchSide::Outer] {
        check(&board, &settings(0.3, 0.07, side));
    }
}

/// A square of side 2 with holes of the shape of triangles and squares: some by themselves, some
/// touch in a vertex.
fn sieve() -> TriMesh {
    let mut sieve = square(12);
    let is_hole = |t: &usize| {
        let (cell, half) = (t / 2, t % 2);
        match (cell % 12, cell / 12) {
            (2 | 8, 2) => half == 0,
            // Two squares with a vertex in common.
            (5, 5) | (6, 6) => true,
            // Three triangles around a vertex.
            (2, 8) | (3, 7) => half == 0,
            (2, 7) => half == 1,
            _ => false,
        }
    };
    let kept = (0..sieve.triangles.len()).filter(|t| !is_hole(t)).map(|t| sieve.triangles[t]).collect();
    sieve.triangles = kept;
    sieve
}

/// Handles of a closed mesh of one part.
fn handles(mesh: &TriMesh) -> i64 {
    let vertices: BTreeSet<u32> = mesh.triangles.as_flattened().iter().copied().collect();
    1 - (vertices.len() as i64 - mesh.triangles.len() as i64 / 2) / 2
}

#[test]
fn holes_that_the_lattice_cannot_see_are_closed_and_said() {
    let sieve = sieve();
    for side in [PatchSide::Inner, PatchSide::Outer] {
        // Triangular holes are 0.1 wide, square ones 0.17.
        let result = check(&sieve, &settings(0.6, 0.1, side));
        assert_eq!(result.statistics.capped.len(), 6, "{:?}", result.statistics.capped);
        assert!(result.statistics.capped.iter().all(|p| sieve.vertices.contains(p)));
        let volume = signed_volume(&result.mesh);
        assert!((volume / 2.4 - 1.0).abs() < 0.005, "{volume}");
    }
}

#[test]
fn holes_that_it_can_see_stay() {
    for side in [PatchSide::Inner, PatchSide::Outer] {
        let result = check(&sieve(), &settings(0.1, 0.012, side));
        assert_eq!(result.statistics.capped, Vec::<[f64; 3]>::new());
        assert_eq!(handles(&result.mesh), 6);
        let volume = signed_volume(&result.mesh);
        let expected = 0.1 * (4.0 - 9.0 / 72.0);
        assert!((volume / expected - 1.0).abs() < 0.01, "{volume}, not {expected}");
    }
}

#[test]
fn a_folded_patch_is_merged_with_itself() {
    // A strip bent to a U, whose legs are nearer to each other than twice the thickness.
    let strip = surface(24, 6, false, |u, v| {
        let (arm, r) = (1.0, 0.25);
        let along = u * (2.0 * arm + PI * r);
        let (x, z) = if along < arm {
            (-along, r)
        } else if along < arm + PI * r {
            let a = (along - arm) / r;
            (-arm - r * a.sin(), r * a.cos())
        } else {
            (along - 2.0 * arm - PI * r, -r)
        };
        [x, v, z]
    });
    for side in [PatchSide::Inner, PatchSide::Outer] {
        check(&strip, &settings(0.4, 0.08, side));
    }
}

#[test]
fn what_is_no_oriented_patch_is_refused_with_its_place() {
    let thin = settings(0.1, 0.03, PatchSide::Inner);
    let mut moebius = surface(24, 2, false, |u, v| {
        let (turn, r) = (PI * u, 0.4 * (v - 0.5));
        let around = 1.0 + r * turn.cos();
        [around * (TAU * u).cos(), around * (TAU * u).sin(), r * turn.sin()]
    });
    // The last column is the first one upside down.
    for triangle in &mut moebius.triangles {
        for v in triangle.iter_mut().filter(|v| **v % 25 == 24) {
            *v = (2 - *v / 25) * 25;
        }
    }
    assert!(matches!(refused(&moebius, &thin), ThickenError::Patch(PatchError::Misoriented { .. })));

    let crossing = both(square(2), surface(2, 2, false, |u, v| [0.1, u - 0.5, v - 0.5]));
    let ThickenError::Patch(PatchError::Intersects { at, .. }) = refused(&crossing, &thin) else { panic!() };
    assert!((at[0] - 0.1).abs() < 1e-6 && at[2].abs() < 1e-6, "{at:?}");

    let empty = TriMesh::default();
    assert!(matches!(refused(&empty, &thin), ThickenError::Patch(PatchError::NoTriangles)));
    let coarse = settings(0.1, 0.05, PatchSide::Inner);
    assert!(matches!(
        refused(&square(2), &coarse),
        ThickenError::Settings(ThickenSettingsError::TooCoarse { .. })
    ));
}

#[test]
fn a_thickness_map_is_followed() {
    let patch = square(8);
    let map: Vec<f64> = patch.vertices.iter().map(|v| 0.2 + 0.05 * v[0]).collect();
    let result =
        check(&patch, &ThickenSettings { thickness_map: Some(map), ..settings(0.2, 0.05, PatchSide::Inner) });
    assert!((signed_volume(&result.mesh) / 0.8 - 1.0).abs() < 0.01);
    let wrong =
        ThickenSettings { thickness_map: Some(vec![0.1; 3]), ..settings(0.2, 0.05, PatchSide::Inner) };
    assert!(matches!(
        refused(&patch, &wrong),
        ThickenError::Settings(ThickenSettingsError::Map { values: 3, .. })
    ));
}

#[test]
fn the_same_bytes_for_every_number_of_threads() {
    let wave = surface(12, 12, false, |u, v| [2.0 * u, 2.0 * v, 0.3 * (5.0 * u).sin() * (4.0 * v).cos()]);
    let with = |threads| {
        let run = RunSettings::with_threads(threads).unwrap();
        thicken(&wave, &settings(0.2, 0.06, PatchSide::Inner), &run).unwrap().mesh
    };
    let one = with(1);
    // The patch, a sheet behind it and a rim.
    assert!(one.triangles.len() > 3 * wave.triangles.len(), "{}", one.triangles.len());
    assert!(one == with(2) && one == with(5));
}
