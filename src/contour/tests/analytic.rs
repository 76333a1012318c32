//! Surfaces with known answers.

use crate::contour::tests::fields::{Implicit, run, sample};
use crate::contour::{ContourError, ContourSettings, Precision, contour};
use crate::lattice::{Lattice, LatticeError};
use crate::mesh::TriMesh;
use crate::run::RunSettings;
use crate::verify::tests::audit::audit;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn volume(mesh: &TriMesh) -> f64 {
    let six = |[a, b, c]: [[f64; 3]; 3]| {
        dot(a, [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]])
    };
    (0..mesh.triangles.len()).map(|t| six(mesh.corners(t))).sum::<f64>() / 6.0
}

fn euler(mesh: &TriMesh) -> i64 {
    // Every triangle has three half edges.
    mesh.vertices.len() as i64 - mesh.triangles.len() as i64 / 2
}

/// A ball.
pub struct Ball {
    pub centre: [f64; 3],
    pub radius: f64,
}

impl Implicit for Ball {
    fn at(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let d = std::array::from_fn(|i| p[i] - self.centre[i]);
        let length = dot(d, d).sqrt();
        (length - self.radius, d.map(|x| x / length))
    }
}

/// An intersection of half-spaces.
pub struct Solid(pub Vec<([f64; 3], f64)>);

impl Implicit for Solid {
    fn at(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let values = self.0.iter().map(|&(n, d)| (dot(n, p) - d, n));
        values.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
    }
}

/// Three orthonormal directions, generic ones.
fn frame() -> [[f64; 3]; 3] {
    let (a, b) = (0.7f64, 0.4f64);
    let (ca, sa, cb, sb) = (a.cos(), a.sin(), b.cos(), b.sin());
    [[ca, sa, 0.0], [-sa * cb, ca * cb, sb], [sa * sb, -ca * sb, cb]]
}

/// The box of half-sides `half` around `centre` along the directions `frame`, and its corners.
fn solid_box(frame: [[f64; 3]; 3], centre: [f64; 3], half: [f64; 3]) -> (Solid, Vec<[f64; 3]>) {
    let mut planes = Vec::new();
    for (axis, half) in frame.into_iter().zip(half) {
        planes.push((axis, dot(axis, centre) + half));
        planes.push((axis.map(|x| -x), half - dot(axis, centre)));
    }
    let corners = (0..8).map(|c| {
        std::array::from_fn(|k| {
            let along = |a: usize| if c >> a & 1 == 1 { half[a] } else { -half[a] };
            centre[k] + (0..3).map(|a| along(a) * frame[a][k]).sum::<f64>()
        })
    });
    (Solid(planes), corners.collect())
}

fn nearest(mesh: &TriMesh, p: [f64; 3]) -> f64 {
    let distance2 = |v: &[f64; 3]| (0..3).map(|i| (v[i] - p[i]).powi(2)).sum::<f64>();
    mesh.vertices.iter().map(distance2).fold(f64::INFINITY, f64::min).sqrt()
}

fn assert_clean(mesh: &TriMesh) {
    let audit = audit(mesh);
    assert!(audit.is_sound() && audit.intersections.tested as usize >= mesh.triangles.len(), "{audit:?}");
}

#[test]
fn spheres_are_spheres_and_converge() {
    let mut errors = Vec::new();
    for (n, voxel) in [(12, 0.1), (24, 0.05), (48, 0.025)] {
        let ball = Ball { centre: [0.013, -0.021, 0.007], radius: 1.0 };
        let (mesh, statistics) = run(&sample(&ball, n, voxel), voxel, Precision::F32, 2);
        assert_clean(&mesh);
        assert_eq!(euler(&mesh), 2);
        assert_eq!(statistics.several_sheets, 0);
        assert_eq!(statistics.triangles, mesh.triangles.len() as u64);
        assert_eq!(
            statistics.triangles,
            2 * statistics.quads + 2 * statistics.split + statistics.face_vertices * 2
        );
        errors.push((volume(&mesh) / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs());
        let far = mesh.vertices.iter().map(|&v| ball.at(v).0.abs()).fold(0.0, f64::max);
        assert!(far < 0.5 * voxel * voxel, "{far}");
    }
    // Second order: each halving of the voxel leaves about a quarter.
    assert!(errors[0] < 1e-2 && errors[1] < 0.35 * errors[0] && errors[2] < 0.35 * errors[1], "{errors:?}");
}

#[test]
fn vertices_lie_on_planes() {
    let normal = frame()[2];
    let mut planes = solid_box([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3], [9.3; 3]).0;
    planes.0.push((normal, 0.234));
    let voxel = 1.0;
    let (mesh, _) = run(&sample(&planes, 12, voxel), voxel, Precision::F64, 2);
    assert_clean(&mesh);
    let inner = |v: &&[f64; 3]| v.iter().all(|x| x.abs() < 7.0);
    let on_plane: Vec<_> = mesh.vertices.iter().filter(inner).collect();
    let mut free = 0;
    for &&v in &on_plane {
        let distance = (dot(normal, v) - 0.234).abs();
        // Where the plane just cuts off a corner of the cell, the margin counts.
        let at_margin = v.iter().filter(|x| (*x - x.round()).abs() < 1.001e-3).count() > 0;
        free += usize::from(!at_margin);
        assert!(distance < if at_margin { 2e-3 } else { 1e-6 }, "{v:?}: {distance}");
    }
    assert!(free > 200 && 100 * free > 98 * on_plane.len());
}

/// Whether the crossings of the cell that contains `corner` are on all three of its planes.
fn cell_sees_three_planes(solid: &Solid, corner: [f64; 3], voxel: f64) -> bool {
    let low = corner.map(|x| (x / voxel).floor());
    let mut seen = Vec::new();
    for edge in 0..12 {
        let (axis, side) = (edge / 4, edge % 4);
        let at = |t: f64| {
            let mut p = low;
            p[axis] += t;
            p[(axis + 1) % 3] += f64::from(side as u8 & 1);
            p[(axis + 2) % 3] += f64::from(side as u8 >> 1);
            solid.at(p.map(|x| x * voxel))
        };
        let (mut a, mut b) = (0.0, 1.0);
        let first = at(a).0 < 0.0;
        if first == (at(b).0 < 0.0) {
            continue;
        }
        for _ in 0..50 {
            let t = 0.5 * (a + b);
            if (at(t).0 < 0.0) == first { a = t } else { b = t }
        }
        if !seen.contains(&at(a).1) {
            seen.push(at(a).1);
        }
    }
    seen.len() == 3
}

#[test]
fn rotated_boxes_have_their_corners() {
    let voxel = 0.1;
    let half = [0.9, 0.7, 0.53];
    let (mut exact, mut blunt) = (0, 0);
    for n in 0..10 {
        let centre = [0.03 + 0.013 * f64::from(n), 0.01, -0.02 * f64::from(n)];
        let (solid, corners) = solid_box(frame(), centre, half);
        for (precision, tolerance) in [(Precision::F32, 1e-6), (Precision::F64, 1e-6 * voxel)] {
            let (mesh, _) = run(&sample(&solid, 18, voxel), voxel, precision, 2);
            assert_clean(&mesh);
            assert_eq!(euler(&mesh), 2);
            assert!((volume(&mesh) / (8.0 * 0.9 * 0.7 * 0.53) - 1.0).abs() < 3e-3, "{}", volume(&mesh));
            for &corner in &corners {
                let distance = nearest(&mesh, corner);
                if cell_sees_three_planes(&solid, corner, voxel) {
                    exact += 1;
                    assert!(distance < tolerance, "{distance}");
                } else {
                    // The corner pokes out of the cells that see its planes; their vertices cannot
                    // follow.
                    blunt += 1;
                    assert!(distance < voxel, "{distance}");
                }
            }
        }
    }
    // The cells of most corners of a rotated box see two planes or fewer.
    assert!(exact >= 40, "{exact} exact corners, {blunt} blunt ones");
}

#[test]
fn aligned_boxes_are_exact() {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let (solid, corners) = solid_box(axes, [0.25, 0.5, 0.125], [5.125, 4.0625, 3.25]);
    let (mesh, statistics) = run(&sample(&solid, 9, 1.0), 1.0, Precision::F32, 2);
    assert_clean(&mesh);
    assert_eq!((euler(&mesh), statistics.clamped, statistics.split), (2, 0, 0));
    assert!(corners.iter().all(|&c| nearest(&mesh, c) < 1e-6));
    // Nothing of the box is missing: all edges are sharp.
    assert!((volume(&mesh) - 8.0 * 5.125 * 4.0625 * 3.25).abs() < 1e-4, "{}", volume(&mesh));
    assert!(mesh.vertices.iter().all(|&v| solid.at(v).0.abs() < 1e-6));
}

/// Plates thinner than a voxel, where most cells have two sheets and some are missed by the
/// lattice.
#[test]
fn thin_plates_are_clean() {
    for half in [0.2, 0.35, 0.6] {
        let mut plate = solid_box(frame(), [0.01, 0.02, 0.03], [7.0, 6.0, half]).0;
        plate.0.push(([0.0, 0.6, 0.8], 5.0));
        let (mesh, statistics) = run(&sample(&plate, 12, 1.0), 1.0, Precision::F32, 2);
        assert_clean(&mesh);
        assert!(statistics.several_sheets > 20, "{statistics:?}");
    }
}

#[test]
fn threads_do_not_change_a_byte() {
    let field = sample(&Ball { centre: [0.3; 3], radius: 19.0 }, 21, 1.0);
    let one = run(&field, 1.0, Precision::F32, 1);
    assert!(one.0.triangles.len() > 10_000);
    for threads in [2, 8] {
        assert_eq!(run(&field, 1.0, Precision::F32, threads), one);
    }
}

#[test]
fn nothing_gives_an_empty_mesh() {
    let (mesh, statistics) =
        run(&sample(&Ball { centre: [0.5; 3], radius: 0.1 }, 3, 1.0), 1.0, Precision::F32, 1);
    assert!(mesh.triangles.is_empty() && mesh.vertices.is_empty() && statistics.cells == 0);
}

#[test]
fn stops_when_cancelled_and_when_too_far() {
    let (signs, crossings) = sample(&Ball { centre: [0.3; 3], radius: 5.0 }, 6, 1.0);
    let settings = ContourSettings::default();
    let cancelled = RunSettings::with_threads(1).unwrap();
    cancelled.cancel_token().cancel();
    let result = contour(&signs, &crossings, Lattice { voxel: 1.0 }, None, &settings, &cancelled);
    assert!(matches!(result, Err(ContourError::Cancelled(_))));

    let far = super::fields::signs(
        crate::lattice::Ijk([3_000_000; 3]),
        crate::lattice::Ijk([3_000_001; 3]),
        |_| true,
    );
    let crossings = super::fields::crossings(&far, |_, _| crate::edge::Crossing {
        t: 0.5,
        normal: [1.0, 0.0, 0.0],
        triangle: 0,
    });
    let run = RunSettings::with_threads(1).unwrap();
    let result = contour(&far, &crossings, Lattice { voxel: 0.1 }, None, &settings, &run);
    assert!(matches!(result, Err(ContourError::Lattice(LatticeError::CoarseCoordinates { .. }))));
    assert!(result.unwrap_err().to_string().contains("64-bit"));
    let wide = ContourSettings { precision: Precision::F64, ..ContourSettings::default() };
    assert!(contour(&far, &crossings, Lattice { voxel: 0.1 }, None, &wide, &run).is_ok());
}
