use super::*;
use crate::mesh::{Topology, TriMesh};
use crate::run::RunSettings;
use glam::DVec3;
use proptest::prelude::*;

/// Returns a box with given half-extents, moved, each face two triangles.
fn cuboid(half: [f64; 3], centre: DVec3) -> TriMesh {
    let corner = |n: usize| {
        let s = |bit: usize| if n >> bit & 1 == 1 { 1.0 } else { -1.0 };
        (centre + DVec3::new(s(0) * half[0], s(1) * half[1], s(2) * half[2])).to_array()
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { vertices: (0..8).map(corner).collect(), triangles }
}

/// Exact signed distance of a box.
fn box_distance(p: DVec3, half: [f64; 3], centre: DVec3) -> f64 {
    let d = (p - centre).abs() - DVec3::from(half);
    d.max(DVec3::ZERO).length() + d.max_element().min(0.0)
}

fn check_box(half: [f64; 3], centre: DVec3, q: DVec3) {
    let mesh = cuboid(half, centre);
    let topology = Topology::new(&mesh);
    assert!(topology.defects().is_closed());
    let field = SignedDistance::new(&mesh, &topology);
    let p = centre + q;
    let (expected, sample) = (box_distance(p, half, centre), field.at(p, 0));
    let scale = centre.length() + q.length() + half[0] + half[1] + half[2];
    assert!((sample.distance - expected).abs() < 1e-14 * scale, "{p}: {sample:?}, {expected}");
    if expected.abs() > 1e-14 * scale {
        assert_eq!(sample.distance > 0.0, expected > 0.0, "{p}");
    }
}

proptest! {
    #[test]
    fn a_box_has_its_exact_signed_distance(
        half in prop::array::uniform3(0.01..2.0f64),
        q in prop::array::uniform3(-4.0..4.0f64),
        far in prop::sample::select(vec![0.0, 1.0, 1e6]),
    ) {
        check_box(half, DVec3::new(far, -far, 0.5 * far), DVec3::from(q));
    }
}

#[test]
fn the_sign_is_right_where_faces_edges_and_vertices_meet() {
    // Points exactly on the planes between the regions, where closest features tie.
    let half = [1.0, 0.5, 0.25];
    let steps = [-2.0, -1.0, -0.5, -0.25, 0.0, 0.1, 0.25, 0.5, 1.0, 2.0];
    for x in steps {
        for y in steps {
            for z in steps {
                check_box(half, DVec3::ZERO, DVec3::new(x, y, z));
            }
        }
    }
}

/// Crossing parity along a ray: the oracle for the sign on non-convex solids.
fn inside_by_parity(mesh: &TriMesh, p: DVec3) -> bool {
    let direction = DVec3::new(0.541_196_1, 0.306_562_9, 0.783_412_7);
    let crossings = (0..mesh.triangles.len()).filter(|&t| {
        let [a, b, c] = mesh.corners(t).map(|v| DVec3::from(v) - p);
        let volume = |u: DVec3, v: DVec3| direction.dot(u.cross(v));
        let (x, y, z) = (volume(a, b), volume(b, c), volume(c, a));
        let same = (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0);
        let n = (b - a).cross(c - a);
        same && a.dot(n) / direction.dot(n) > 0.0
    });
    crossings.count() % 2 == 1
}

/// Returns a star-shaped solid with deep folds and sharp spikes.
fn spiky(rings: usize, sectors: usize) -> TriMesh {
    let mut mesh = TriMesh::default();
    let radius = |i: usize, j: usize| {
        if (i * 5 + j * 3).is_multiple_of(4) { 2.0 } else { 0.3 + 0.1 * ((i + j) % 3) as f64 }
    };
    mesh.vertices.push([0.0, 0.0, -1.0]);
    for i in 0..rings {
        let theta = std::f64::consts::PI * ((i + 1) as f64 / (rings + 1) as f64);
        for j in 0..sectors {
            let phi = std::f64::consts::TAU * j as f64 / sectors as f64;
            let r = radius(i, j);
            mesh.vertices.push([r * theta.sin() * phi.cos(), r * theta.sin() * phi.sin(), -r * theta.cos()]);
        }
    }
    mesh.vertices.push([0.0, 0.0, 1.0]);
    let last = mesh.vertices.len() as u32 - 1;
    let at = |i: usize, j: usize| (1 + i * sectors + j % sectors) as u32;
    for j in 0..sectors {
        mesh.triangles.push([0, at(0, j + 1), at(0, j)]);
        for i in 0..rings - 1 {
            mesh.triangles.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            mesh.triangles.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
        mesh.triangles.push([last, at(rings - 1, j), at(rings - 1, j + 1)]);
    }
    mesh
}

#[test]
fn the_sign_agrees_with_parity_on_a_spiky_solid() {
    let mesh = spiky(7, 12);
    let topology = Topology::new(&mesh);
    assert!(topology.defects().is_closed());
    let field = SignedDistance::new(&mesh, &topology);
    let mut inside = 0;
    for n in 0..8000 {
        let [i, j, k] = [n % 20, n / 20 % 20, n / 400].map(|x| (x as f64 - 9.37) * 0.21);
        let p = DVec3::new(i, j, k);
        let expected = inside_by_parity(&mesh, p);
        assert_eq!(field.at(p, 0).distance < 0.0, expected, "{p}");
        inside += usize::from(expected);
    }
    assert!(inside > 100, "the test must reach the inside: {inside}");
}

#[test]
fn the_gradient_points_outward_on_both_sides() {
    let mesh = cuboid([1.0; 3], DVec3::ZERO);
    let topology = Topology::new(&mesh);
    let field = SignedDistance::new(&mesh, &topology);
    for (p, n) in [
        (DVec3::new(1.5, 0.2, 0.1), DVec3::X),
        (DVec3::new(0.5, 0.2, 0.1), DVec3::X),
        (DVec3::new(1.0, 0.2, 0.1), DVec3::X),
        (DVec3::new(2.0, 2.0, 0.1), DVec3::new(1.0, 1.0, 0.0).normalize()),
        (DVec3::new(1.0, 1.0, 0.1), DVec3::new(1.0, 1.0, 0.0).normalize()),
    ] {
        let gradient = field.gradient(p, &field.at(p, 0), 1e-9);
        assert!((gradient - n).length() < 1e-12, "{p}: {gradient}");
    }
}

#[test]
fn the_depth_of_a_box_is_half_its_thickness() {
    let mesh = cuboid([1.0, 0.3, 2.0], DVec3::new(5.0, 0.1, -3.0));
    let depth = depth_of(&mesh, 1e-3);
    assert!((0.3 * 0.998..=0.3 + 1e-12).contains(&depth.at_least), "{depth:?}");
    assert!((0.3 - 1e-12..=0.3 * 1.002).contains(&depth.at_most), "{depth:?}");
}

/// How deep a mesh is.
fn depth_of(mesh: &TriMesh, relative: f64) -> Depth {
    let topology = Topology::new(mesh);
    let run = RunSettings::with_threads(1).unwrap();
    largest_depth(&SignedDistance::new(mesh, &topology), relative, &run).unwrap()
}

#[test]
fn the_depth_of_plates_and_needles_is_bounded_in_a_bounded_search() {
    // Every part of a plate is as deep as any other: a search that has to look at all of it does
    // not end.
    for half in [[127.5f64, 138.5, 1.5], [100.0, 1e-3, 1e-3], [5.0, 4.0, 1e-9]] {
        let (longest, thinnest) = (half[0].max(half[1]), half[1].min(half[2]));
        let depth = depth_of(&cuboid(half, DVec3::ZERO), 1e-3);
        let (least, most) = (thinnest * (1.0 - 1e-12), 1.01 * thinnest + 1e-3 * longest);
        assert!(depth.at_least <= thinnest * (1.0 + 1e-12), "{half:?}: {depth:?}");
        assert!((least..=most).contains(&depth.at_most), "{half:?}: {depth:?}");
    }
    // Tilted, its bounding box is not thin.
    let mut tilted = cuboid([127.5, 138.5, 1.5], DVec3::ZERO);
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 0.7, 0.2);
    for v in &mut tilted.vertices {
        *v = (turn * DVec3::from(*v)).to_array();
    }
    let depth = depth_of(&tilted, 1e-3);
    assert!(depth.at_least <= 1.5 + 1e-9 && (1.5 - 1e-9..8.0).contains(&depth.at_most), "{depth:?}");
}

#[test]
fn the_search_for_the_deepest_point_can_be_cancelled() {
    let mesh = cuboid([100.0, 1.0, 90.0], DVec3::ZERO);
    let topology = Topology::new(&mesh);
    let run = RunSettings::with_threads(1).unwrap();
    run.cancel_token().cancel();
    let depth = largest_depth(&SignedDistance::new(&mesh, &topology), 1e-9, &run);
    assert!(depth.is_err(), "{depth:?}");
}
