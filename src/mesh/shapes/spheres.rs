//! Geodesic spheres.

use super::builder::{Builder, Point, add};
use crate::mesh::TriMesh;
use std::collections::BTreeMap;

/// Returns the unit sphere about the origin, its vertices on it: an icosahedron with poles on the z
/// axis, each face divided evenly.
pub fn sphere(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    add_sphere(&mut b, [0.0; 3], 1.0, Side::Outward);
    b.finish()
}

/// Two unit spheres that touch at the origin, in one vertex that both use: an edge-manifold mesh
/// with one vertex that is not manifold.
pub fn touching_spheres(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    let lower = add_sphere(&mut b, [0.0, 0.0, -1.0], 1.0, Side::Outward);
    let upper = add_sphere(&mut b, [0.0, 0.0, 1.0], 1.0, Side::Outward);
    let mut mesh = b.finish();
    // The upper sphere's south pole is the lower one's north pole; the last vertex takes its
    // number.
    let (kept, dropped) = (lower.north, upper.south);
    mesh.vertices.swap_remove(dropped as usize);
    let last = mesh.vertices.len() as u32;
    for v in mesh.triangles.iter_mut().flatten() {
        *v = if *v == dropped {
            kept
        } else if *v == last {
            dropped
        } else {
            *v
        };
    }
    mesh
}

/// The gap between [`near_spheres`], in model units: far below any usual voxel.
pub const NEAR_GAP: f64 = 1e-3;

/// Two unit spheres [`NEAR_GAP`] apart.
pub fn near_spheres(detail: u32) -> TriMesh {
    let mut b = Builder::new(detail);
    for side in [-1.0, 1.0] {
        add_sphere(&mut b, [0.0, 0.0, side * (1.0 + 0.5 * NEAR_GAP)], 1.0, Side::Outward);
    }
    b.finish()
}

/// The side that a sphere's triangles face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Away from the centre: a ball.
    Outward,
    /// Towards the centre: a cavity.
    Inward,
}

/// The numbers of the vertices on the z axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Poles {
    pub north: u32,
    pub south: u32,
}

/// Adds a geodesic sphere.
pub(super) fn add_sphere(b: &mut Builder, centre: Point, radius: f64, side: Side) -> Poles {
    let (corners, faces) = icosahedron();
    // The icosahedron's sides are 1.05 radii long, and somewhat longer on the sphere.
    let n = b.divisions(1.1 * radius, 1) as u32;
    let mut seen: BTreeMap<[(usize, u32); 3], u32> = BTreeMap::new();
    let mut at = |b: &mut Builder, mut weights: [(usize, u32); 3]| {
        // Named by its corners with weight, in order, a vertex has one name in all faces that share
        // it.
        weights.iter_mut().filter(|w| w.1 == 0).for_each(|w| w.0 = usize::MAX);
        weights.sort_unstable();
        *seen.entry(weights).or_insert_with(|| {
            let mut p = [0.0; 3];
            for (corner, weight) in weights.into_iter().filter(|w| w.1 > 0) {
                p = add(p, corners[corner].map(|x| x * f64::from(weight)));
            }
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            b.vertex(add(centre, p.map(|x| radius * (x / length))))
        })
    };
    let mut poles = Poles { north: 0, south: 0 };
    for [p, q, r] in faces {
        let (p, q, r) = if side == Side::Outward { (p, q, r) } else { (p, r, q) };
        for i in 0..n {
            for j in 0..n - i {
                let mut corner = |b: &mut Builder, i: u32, j: u32| at(b, [(p, n - i - j), (q, i), (r, j)]);
                let (v00, v10, v01) = (corner(b, i, j), corner(b, i + 1, j), corner(b, i, j + 1));
                b.triangle(v00, v10, v01);
                if i + j + 2 <= n {
                    let v11 = corner(b, i + 1, j + 1);
                    b.triangle(v10, v11, v01);
                }
            }
        }
        poles.north = at(b, [(0, n), (1, 0), (2, 0)]);
        poles.south = at(b, [(11, n), (1, 0), (2, 0)]);
    }
    poles
}

/// Corners (0 is the north pole, 11 the south pole) and faces.
fn icosahedron() -> ([Point; 12], [[usize; 3]; 20]) {
    let mut corners = [[0.0; 3]; 12];
    corners[0] = [0.0, 0.0, 1.0];
    corners[11] = [0.0, 0.0, -1.0];
    let (z, ring) = (1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt());
    let mut faces = [[0; 3]; 20];
    for i in 0..5 {
        let angle = std::f64::consts::TAU * i as f64 / 5.0;
        let shifted = angle + std::f64::consts::PI / 5.0;
        corners[1 + i] = [ring * angle.cos(), ring * angle.sin(), z];
        corners[6 + i] = [ring * shifted.cos(), ring * shifted.sin(), -z];
        let next = (i + 1) % 5;
        faces[4 * i] = [0, 1 + i, 1 + next];
        faces[4 * i + 1] = [1 + i, 6 + i, 1 + next];
        faces[4 * i + 2] = [1 + next, 6 + i, 6 + next];
        faces[4 * i + 3] = [11, 6 + next, 6 + i];
    }
    (corners, faces)
}
