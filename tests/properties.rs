//! Properties that an offset does not depend on: where the model lies, which way it is turned, its
//! scale, and the order of its vertices and triangles.
//!
//! Each property is as strong as it can be. Scaling by a power of two changes no digit, so the
//! result has the same digits. Moves that map the lattice to itself change the order of sums and
//! which of two equal triangles is the closest, so results agree up to rounding, but for a few
//! places where two answers are equally right. After any other motion the lattice cuts the model
//! elsewhere, and what is left is the solid: volume, pieces and handles.

mod common;

use common::random::Random;
use exocarp::internals::mesh::Topology;
use exocarp::internals::mesh::measure::{area, signed_volume};
use exocarp::verify::soundness;
use exocarp::{
    Length, OffsetSettings, Precision, RunSettings, Tolerance, TriMesh, VoxelSize, offset, shapes,
};
use glam::{DMat3, DQuat, DVec3};
use std::collections::HashMap;

/// A power of two, so that moves by whole voxels are exact.
const VOXEL: f64 = 1.0 / 32.0;

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

/// Models whose coordinates are multiples of 2^-20: moves by voxels round nothing.
fn models() -> Vec<(&'static str, TriMesh)> {
    let on_grid = |mut mesh: TriMesh| {
        let rotation = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.7).normalize(), 0.6);
        for v in &mut mesh.vertices {
            let turned = (rotation * DVec3::from(*v)).to_array();
            *v = turned.map(|x| (x * f64::from(1 << 20)).round() / f64::from(1 << 20));
        }
        mesh
    };
    vec![
        ("carved_cube", on_grid(shapes::carved_cube(6))),
        ("bracket", on_grid(shapes::bracket(6))),
        ("flower", on_grid(shapes::flower(8))),
    ]
}

fn settings(distance: f64) -> OffsetSettings {
    OffsetSettings {
        distance: Length::Units(distance),
        voxel: VoxelSize::Units(VOXEL),
        precision: Precision::F64,
        ..OffsetSettings::default()
    }
}

/// Offsets a mesh and asserts that the result is sound.
fn made(mesh: &TriMesh, settings: &OffsetSettings) -> TriMesh {
    let result = offset(mesh, settings, &run()).unwrap().mesh;
    let broken = soundness(&result, &run()).unwrap().broken();
    assert!(broken.is_empty(), "{broken:?}");
    result
}

fn mapped(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    let vertices = mesh.vertices.iter().map(|&v| map(DVec3::from(v)).to_array()).collect();
    TriMesh { vertices, triangles: mesh.triangles.clone() }
}

/// The share of the vertices of `a` that have a vertex of `b` within `reach`.
fn share_found(a: &TriMesh, b: &TriMesh, reach: f64) -> f64 {
    let cell = |p: DVec3| (p / VOXEL).floor().as_i64vec3();
    let mut cells: HashMap<_, Vec<DVec3>> = HashMap::new();
    for &v in &b.vertices {
        cells.entry(cell(v.into())).or_default().push(v.into());
    }
    let is_found = |v: &&[f64; 3]| {
        let p = DVec3::from(**v);
        let around = (0..27).map(|n| glam::I64Vec3::new(n / 9, n / 3 % 3, n % 3) - 1);
        let near = around.filter_map(|d| cells.get(&(cell(p) + d)));
        near.flatten().any(|q| q.distance(p) <= reach)
    };
    a.vertices.iter().filter(is_found).count() as f64 / a.vertices.len() as f64
}

/// Pieces, and vertices less half the triangles.
fn shape(mesh: &TriMesh) -> (usize, i64) {
    (Topology::new(mesh).components(), mesh.vertices.len() as i64 - mesh.triangles.len() as i64 / 2)
}

fn assert_near(a: f64, b: f64, relative: f64, what: &str) {
    assert!((a / b - 1.0).abs() <= relative, "{what}: {a} and {b}");
}

/// Asserts that two meshes are the same up to rounding, but for a few vertices: at least `share` of
/// them have one of the other mesh at their place.
#[track_caller]
fn assert_same_surface(a: &TriMesh, b: &TriMesh, share: f64, what: &str) {
    assert_eq!(shape(a), shape(b), "{what}");
    let found = share_found(a, b, 1e-6 * VOXEL).min(share_found(b, a, 1e-6 * VOXEL));
    assert!(found >= share, "{what}: {found} of the vertices");
    assert_near(signed_volume(a), signed_volume(b), 1e-5, what);
    // A quadrilateral that is not flat has another area with its other diagonal.
    assert_near(area(a), area(b), 1e-3, what);
}

#[test]
fn scaling_by_a_power_of_two_changes_no_digit() {
    for (name, mesh) in models() {
        for (distance, tolerance, precision) in [
            (0.07, None, Precision::F64),
            (-0.04, None, Precision::F32),
            (0.05, Some(0.05), Precision::F64),
            (0.0, None, Precision::F64),
        ] {
            let at = |scale: f64| {
                let settings = OffsetSettings {
                    voxel: VoxelSize::Units(scale * VOXEL),
                    tolerance: tolerance.map(|t| Tolerance::Units(scale * t * VOXEL)),
                    precision,
                    ..settings(scale * distance)
                };
                made(&mapped(&mesh, |p| scale * p), &settings)
            };
            let expected = at(1.0);
            for exponent in [-9, 13] {
                let scale = 2f64.powi(exponent);
                let back = mapped(&at(scale), |p| p / scale);
                assert!(back == expected, "{name} {distance} {tolerance:?}: digits differ at {scale}");
            }
        }
    }
}

#[test]
fn moves_by_whole_voxels_move_the_result() {
    for (name, mesh) in models() {
        for distance in [0.07, -0.04] {
            let expected = made(&mesh, &settings(distance));
            // Within a leaf, and by several leaves.
            for voxels in [DVec3::new(1.0, -3.0, 2.0), DVec3::new(-16.0, 40.0, 8.0)] {
                let by = voxels * VOXEL;
                let moved = made(&mapped(&mesh, |p| p + by), &settings(distance));
                assert_same_surface(
                    &mapped(&moved, |p| p - by),
                    &expected,
                    0.99,
                    &format!("{name} {voxels}"),
                );
            }
        }
    }
}

#[test]
fn axes_that_change_places_turn_the_result() {
    let around = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
    let half_turn = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0));
    let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
    for (name, mesh) in models() {
        for distance in [0.07, -0.04] {
            let expected = made(&mesh, &settings(distance));
            for (what, motion) in [("around", around), ("half turn", half_turn), ("mirror", mirror)] {
                let flip = |mut mesh: TriMesh| {
                    if motion.determinant() < 0.0 {
                        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
                    }
                    mesh
                };
                let turned = made(&flip(mapped(&mesh, |p| motion * p)), &settings(distance));
                let back = flip(mapped(&turned, |p| motion.transpose() * p));
                // Of equal answers the first is taken, and the axes have an order.
                assert_same_surface(&back, &expected, 0.95, &format!("{name} {distance} {what}"));
            }
        }
    }
}

/// Numbers from 0 on in a random order.
fn shuffled(count: usize, random: &mut Random) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    for n in (1..count).rev() {
        order.swap(n, random.below(n + 1));
    }
    order
}

#[test]
fn the_order_of_vertices_and_triangles_does_not_matter() {
    let mut random = Random(3);
    for (name, mesh) in models() {
        for distance in [0.07, -0.04] {
            let expected = made(&mesh, &settings(distance));
            for _ in 0..2 {
                let order = shuffled(mesh.vertices.len(), &mut random);
                let mut vertices = mesh.vertices.clone();
                for (old, &new) in order.iter().enumerate() {
                    vertices[new] = mesh.vertices[old];
                }
                let renumbered = |t: [u32; 3]| {
                    let mut t = t.map(|v| order[v as usize] as u32);
                    let first = t[0] as usize % 3;
                    t.rotate_left(first);
                    t
                };
                let triangles = shuffled(mesh.triangles.len(), &mut random)
                    .into_iter()
                    .map(|n| renumbered(mesh.triangles[n]))
                    .collect();
                let other = made(&TriMesh { vertices, triangles }, &settings(distance));
                assert_same_surface(&other, &expected, 0.99, &format!("{name} {distance}"));
            }
        }
    }
}

/// The number of connected parts larger than a voxel. Smaller ones come and go with the lattice, at
/// tips that are thinner than it is wide.
fn parts(mesh: &TriMesh) -> usize {
    let mut part: Vec<usize> = (0..mesh.vertices.len()).collect();
    fn root(part: &mut [usize], mut v: usize) -> usize {
        while part[v] != v {
            part[v] = part[part[v]];
            v = part[v];
        }
        v
    }
    for t in &mesh.triangles {
        let roots = t.map(|v| root(&mut part, v as usize));
        part[roots[0]] = roots[2];
        part[roots[1]] = roots[2];
    }
    let mut volumes: HashMap<usize, f64> = HashMap::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| DVec3::from(mesh.vertices[v as usize]));
        *volumes.entry(root(&mut part, t[0] as usize)).or_default() += a.dot(b.cross(c)) / 6.0;
    }
    volumes.values().filter(|v| v.abs() > VOXEL.powi(3)).count()
}

#[test]
fn any_rigid_motion_keeps_the_solid() {
    let mut random = Random(7);
    let mut unit =
        || DVec3::new(random.within(-1.0..1.0), random.within(-1.0..1.0), random.within(-1.0..1.0));
    for (name, mesh) in models() {
        for distance in [0.07, -0.04, 0.0] {
            let expected = made(&mesh, &settings(distance));
            for _ in 0..2 {
                let (rotation, by) = (DQuat::from_scaled_axis(3.0 * unit()), 5.0 * unit());
                let moved = made(&mapped(&mesh, |p| rotation * p + by), &settings(distance));
                let what = format!("{name} {distance} {rotation} {by}");
                assert_eq!(parts(&moved), parts(&expected), "{what}");
                assert_near(signed_volume(&moved), signed_volume(&expected), 2e-4, &what);
                assert_near(area(&moved), area(&expected), 3e-3, &what);
            }
        }
    }
}
