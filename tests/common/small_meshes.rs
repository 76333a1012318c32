//! Random small meshes of the kinds that people send: needles, sheets, soups, doubled, nested, far
//! away.

use super::random::Random;
use exocarp::{TriMesh, shapes};
use glam::{DQuat, DVec3};

/// A point in the cube of half-side 1.
fn point(r: &mut Random) -> DVec3 {
    DVec3::new(r.within(-1.0..1.0), r.within(-1.0..1.0), r.within(-1.0..1.0))
}

fn rotation(r: &mut Random) -> DQuat {
    match r.below(3) {
        0 => DQuat::IDENTITY,
        _ => DQuat::from_scaled_axis(3.0 * point(r)),
    }
}

/// Moves all vertices.
fn moved(mut mesh: TriMesh, by: impl Fn(DVec3) -> DVec3) -> TriMesh {
    mesh.vertices.iter_mut().for_each(|v| *v = by(DVec3::from(*v)).to_array());
    mesh
}

/// A box of the given half-sides, turned and moved.
fn cuboid(random: &mut Random, half: DVec3, at: DVec3) -> TriMesh {
    let rotation = rotation(random);
    moved(shapes::cube(1), |v| rotation * (v * half) + at)
}

/// A ball between `n` parallels and twice as many meridians.
fn sphere(n: u32) -> TriMesh {
    let mut mesh = TriMesh { vertices: vec![[0.0, 0.0, -1.0]], triangles: Vec::new() };
    let around = 2 * n;
    for i in 1..n {
        let z = -(std::f64::consts::PI * f64::from(i) / f64::from(n)).cos();
        let radius = (1.0 - z * z).sqrt();
        for j in 0..around {
            let angle = std::f64::consts::TAU * f64::from(j) / f64::from(around);
            mesh.vertices.push([radius * angle.cos(), radius * angle.sin(), z]);
        }
    }
    let top = mesh.vertices.len() as u32;
    mesh.vertices.push([0.0, 0.0, 1.0]);
    let at = |i: u32, j: u32| 1 + (i - 1) * around + j % around;
    for j in 0..around {
        mesh.triangles.push([0, at(1, j + 1), at(1, j)]);
        mesh.triangles.push([top, at(n - 1, j), at(n - 1, j + 1)]);
        for i in 1..n - 1 {
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            mesh.triangles.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    mesh
}

fn add(mesh: &mut TriMesh, other: TriMesh) {
    let first = mesh.vertices.len() as u32;
    mesh.vertices.extend(other.vertices);
    mesh.triangles.extend(other.triangles.into_iter().map(|t| t.map(|v| v + first)));
}

fn inside_out(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

/// The kinds of [`small_mesh`].
pub const KINDS: [&str; 15] = [
    "box",
    "needle",
    "sheet",
    "soup",
    "pillow",
    "nested",
    "doubled",
    "crossing",
    "far",
    "tiny",
    "huge",
    "inside_out",
    "noisy",
    "cut",
    "triangle",
];

/// A mesh of the kind with this number.
pub fn small_mesh(kind: usize, random: &mut Random) -> TriMesh {
    let r = random;
    match KINDS[kind] {
        "box" => {
            let half = DVec3::new(r.log_within(-2.0..0.0), r.log_within(-2.0..0.0), r.log_within(-2.0..0.0));
            let at = point(r);
            cuboid(r, half, at)
        }
        "needle" => {
            let thin = r.log_within(-9.0..-1.0);
            cuboid(r, DVec3::new(1.0, thin, thin), DVec3::ZERO)
        }
        "sheet" => {
            let thin = r.log_within(-12.0..-1.0);
            cuboid(r, DVec3::new(1.0, 0.7, thin), DVec3::ZERO)
        }
        "soup" => {
            let mut mesh = TriMesh::default();
            for _ in 0..1 + r.below(100) {
                let (at, size) = (point(r), r.log_within(-3.0..0.0));
                let corners = [at, at + size * point(r), at + size * point(r)];
                add(
                    &mut mesh,
                    TriMesh { vertices: corners.map(|p| p.to_array()).to_vec(), triangles: vec![[0, 1, 2]] },
                );
            }
            mesh
        }
        "pillow" => {
            // Two crumpled squares, joined along their borders only.
            let n = 1 + r.below(4) as u32;
            let crumple = r.log_within(-6.0..-0.5);
            let mut mesh = TriMesh::default();
            let mut border = Vec::new();
            for side in 0..2 {
                for i in 0..=n {
                    for j in 0..=n {
                        let at = DVec3::new(f64::from(i), f64::from(j), 0.0) / f64::from(n);
                        let on_border = i == 0 || j == 0 || i == n || j == n;
                        if side == 0 {
                            border.push(at + crumple * point(r));
                        }
                        let known = border[(i * (n + 1) + j) as usize];
                        mesh.vertices
                            .push(if on_border { known } else { at + crumple * point(r) }.to_array());
                    }
                }
                let first = side * (n + 1) * (n + 1);
                for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                    let a = first + i * (n + 1) + j;
                    for t in [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]] {
                        mesh.triangles.push(if side == 0 { t } else { [t[0], t[2], t[1]] });
                    }
                }
            }
            mesh
        }
        "nested" => {
            let mut mesh = cuboid(r, DVec3::ONE, DVec3::ZERO);
            for _ in 0..1 + r.below(3) {
                let half = DVec3::splat(r.within(0.05..0.6));
                let at = 0.1 * point(r);
                let inner = cuboid(r, half, at);
                add(&mut mesh, if r.one_in(2) { inner } else { inside_out(inner) });
            }
            mesh
        }
        "doubled" => {
            let mut mesh = sphere(4 + r.below(8) as u32);
            let other_side = inside_out(mesh.clone());
            add(&mut mesh, other_side);
            if r.one_in(2) { exocarp::internals::mesh::weld(mesh).0 } else { mesh }
        }
        "crossing" => {
            let mut mesh = cuboid(r, DVec3::ONE, DVec3::ZERO);
            for _ in 0..1 + r.below(3) {
                let half =
                    DVec3::new(r.log_within(-1.5..0.3), r.log_within(-1.5..0.3), r.log_within(-1.5..0.3));
                let at = point(r);
                add(&mut mesh, cuboid(r, half, at));
            }
            mesh
        }
        "far" => {
            let at = r.log_within(0.0..7.0) * point(r);
            cuboid(r, DVec3::ONE, at)
        }
        "tiny" => {
            let scale = r.log_within(-30.0..-3.0);
            moved(cuboid(r, DVec3::ONE, DVec3::ONE), |v| scale * v)
        }
        "huge" => {
            let scale = r.log_within(3.0..30.0);
            moved(cuboid(r, DVec3::ONE, DVec3::ONE), |v| scale * v)
        }
        "inside_out" => inside_out(cuboid(r, DVec3::new(1.0, 0.5, 0.3), DVec3::ZERO)),
        "noisy" => {
            // Noise as large as the triangles folds them over one another.
            let noise = r.log_within(-3.0..-0.5);
            let mut mesh = sphere(5 + r.below(10) as u32);
            mesh.vertices.iter_mut().for_each(|v| *v = (DVec3::from(*v) + noise * point(r)).to_array());
            mesh
        }
        "cut" => {
            let mut mesh = sphere(4 + r.below(8) as u32);
            let keep = r.within(0.3..0.99);
            mesh.triangles.retain(|_| r.within(0.0..1.0) < keep);
            mesh
        }
        _ => {
            let (a, b, c) = (point(r), point(r), point(r));
            let flat = r.log_within(-18.0..0.0);
            let corners = [a, b, a + (b - a) * r.within(0.0..1.0) + flat * c];
            TriMesh { vertices: corners.map(|p| p.to_array()).to_vec(), triangles: vec![[0, 1, 2]] }
        }
    }
}
