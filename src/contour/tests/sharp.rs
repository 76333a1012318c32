//! Creases and corners of polyhedra, given as surfaces to sample.

use crate::contour::tests::fields::{Implicit, Random, run_with, sample};
use crate::contour::{ContourStatistics, Creases, ImplicitSurface, Precision, SurfaceSample};
use crate::mesh::TriMesh;
use crate::verify::tests::audit::audit;
use glam::{DQuat, DVec3};

/// The intersection of half-spaces `normal . p <= offset`, or what is left of space without it.
struct Polyhedron {
    planes: Vec<(DVec3, f64)>,
    is_hollow: bool,
}

impl Polyhedron {
    fn value(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let sample = self.sample(p.into(), 0);
        (sample.distance, sample.gradient.to_array())
    }
}

impl Implicit for Polyhedron {
    fn at(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        self.value(p)
    }

    fn face(&self, p: [f64; 3]) -> u32 {
        let heights = self.planes.iter().map(|(n, c)| n.dot(DVec3::from(p)) - c);
        (0..).zip(heights).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0
    }
}

impl ImplicitSurface for Polyhedron {
    fn creases(&self) -> Creases {
        if self.is_hollow { Creases::Concave } else { Creases::Convex }
    }

    fn curvature(&self) -> f64 {
        0.0
    }

    fn sample(&self, p: DVec3, _: u32) -> SurfaceSample {
        self.sample_triangle(p, self.face(p.to_array()))
    }

    fn sample_triangle(&self, p: DVec3, triangle: u32) -> SurfaceSample {
        let (normal, offset) = self.planes[triangle as usize];
        let sign = if self.is_hollow { -1.0 } else { 1.0 };
        SurfaceSample { distance: sign * (normal.dot(p) - offset), gradient: sign * normal, triangle }
    }
}

/// A convex polyhedron by its corners, its edges between them, and its faces by outward normals
/// through a corner.
struct Shape {
    corners: Vec<DVec3>,
    edges: Vec<[usize; 2]>,
    faces: Vec<(DVec3, usize)>,
}

fn cuboid(half: DVec3) -> Shape {
    let corner = |n: usize| DVec3::from([0, 1, 2].map(|a| if n >> a & 1 == 1 { half[a] } else { -half[a] }));
    let edges = (0..8).flat_map(|n| [1, 2, 4].map(|bit| [n, n | bit])).filter(|[a, b]| a != b).collect();
    let faces = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|n| [(n, 7), (-n, 0)]).collect();
    Shape { corners: (0..8).map(corner).collect(), edges, faces }
}

/// A pyramid over a square, height over half side as given.
fn pyramid(half: f64, height: f64) -> Shape {
    let mut corners: Vec<DVec3> =
        [[1., 1.], [-1., 1.], [-1., -1.], [1., -1.]].map(|[x, y]| DVec3::new(x, y, 0.0) * half).into();
    corners.push(DVec3::Z * height);
    let mut faces = vec![(-DVec3::Z, 0)];
    faces.extend((0..4).map(|i| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        ((b - a).cross(DVec3::Z * height - a).normalize(), i)
    }));
    let edges = (0..4).flat_map(|i| [[i, (i + 1) % 4], [i, 4]]).collect();
    Shape { corners, edges, faces }
}

/// A roof with an angle at its ridge, in degrees, that is `long` from the middle to either end.
fn wedge(angle: f64, depth: f64, long: f64) -> Shape {
    let half = depth * (0.5 * angle).to_radians().tan();
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let corners = vec![
        corner(-long, 0.0, depth),
        corner(long, 0.0, depth),
        corner(-long, -half, 0.0),
        corner(long, -half, 0.0),
        corner(-long, half, 0.0),
        corner(long, half, 0.0),
    ];
    let tilt = (0.5 * angle).to_radians();
    let side = |sign: f64| DVec3::new(0.0, sign * tilt.cos(), tilt.sin());
    let faces = vec![(side(1.0), 0), (side(-1.0), 0), (-DVec3::Z, 2), (DVec3::X, 1), (-DVec3::X, 0)];
    let edges = vec![[0, 1], [2, 3], [4, 5], [0, 2], [0, 4], [2, 4], [1, 3], [1, 5], [3, 5]];
    Shape { corners, edges, faces }
}

/// What a mesh has of a shape: the share of the edges' length with a mesh edge along it within 0.05
/// voxels, the farthest that a corner is from a vertex, and the farthest vertex from the surface,
/// in voxels.
struct Found {
    creases: f64,
    corner: f64,
    vertex: f64,
    statistics: ContourStatistics,
}

fn contoured(shape: &Shape, is_hollow: bool, random: &mut Random) -> Found {
    let [axis, shift] = [(); 2].map(|()| DVec3::from(random.direction()));
    let turn = DQuat::from_axis_angle(axis.normalize(), 6.0 * random.unit());
    let place = |p: DVec3| turn * p + shift;
    let plane = |&(n, at): &(DVec3, usize)| (turn * n, (turn * n).dot(place(shape.corners[at])));
    let polyhedron = Polyhedron { planes: shape.faces.iter().map(plane).collect(), is_hollow };
    let field = sample(&polyhedron, 14, 1.0);
    let (mesh, statistics) = run_with(&field, 1.0, (Precision::F64, None), 2, &polyhedron);
    assert!(audit(&mesh).is_sound());
    let corners = shape.corners.iter().map(|&c| {
        let distances = mesh.vertices.iter().map(|&v| (DVec3::from(v) - place(c)).length());
        distances.fold(f64::INFINITY, f64::min)
    });
    let (mut all, mut present) = (0.0f64, 0.0f64);
    for &[a, b] in &shape.edges {
        let (a, b) = (place(shape.corners[a]), place(shape.corners[b]));
        let count = (4.0 * (b - a).length()) as usize;
        for i in 0..count {
            let p = a.lerp(b, (i as f64 + 0.5) / count as f64);
            all += 1.0;
            present += f64::from(u8::from(has_edge(&mesh, p, (b - a).normalize())));
        }
    }
    // A hollow shape is cut out of a block of nodes, whose outside is not of interest.
    let is_near = |v: &&[f64; 3]| !is_hollow || v.iter().all(|x| x.abs() < 12.0);
    let off = mesh.vertices.iter().filter(is_near).map(|&v| polyhedron.value(v).0.abs());
    Found {
        creases: present / all,
        corner: corners.fold(0.0, f64::max),
        vertex: off.fold(0.0, f64::max),
        statistics,
    }
}

fn has_edge(mesh: &TriMesh, p: DVec3, direction: DVec3) -> bool {
    mesh.triangles.iter().any(|t| {
        (0..3).any(|k| {
            let [a, b] = [t[k], t[(k + 1) % 3]].map(|v| DVec3::from(mesh.vertices[v as usize]));
            let along = (b - a).normalize_or_zero();
            let nearest = a + along * (p - a).dot(along).clamp(0.0, (b - a).length());
            (nearest - p).length() <= 0.05 && along.dot(direction).abs() > 0.995
        })
    })
}

/// The least of the crease shares and the largest of the distances over random rotations and
/// shifts.
fn worst(shape: &Shape, is_hollow: bool, rounds: u64) -> Found {
    let mut worst =
        Found { creases: 1.0, corner: 0.0, vertex: 0.0, statistics: ContourStatistics::default() };
    let mut shares = 0.0;
    for seed in 0..rounds {
        let found = contoured(shape, is_hollow, &mut Random(77 + seed));
        shares += found.creases;
        worst.creases = worst.creases.min(found.creases);
        worst.corner = worst.corner.max(found.corner);
        worst.vertex = worst.vertex.max(found.vertex);
        worst.statistics += found.statistics;
    }
    println!(
        "creases {:.4} at least, {:.4} on average, corners {:.1e}, vertices {:.1e}, {:?}",
        worst.creases,
        shares / rounds as f64,
        worst.corner,
        worst.vertex,
        worst.statistics
    );
    worst.creases = shares / rounds as f64;
    worst
}

fn rounds() -> u64 {
    if super::random::is_heavy() { 60 } else { 6 }
}

#[test]
fn boxes_at_any_rotation_have_their_corners_and_creases() {
    let shape = cuboid(DVec3::new(7.3, 5.1, 6.2));
    for is_hollow in [false, true] {
        let found = worst(&shape, is_hollow, rounds());
        assert!(found.corner < 1e-6 && found.creases > 0.999, "{} {}", found.corner, found.creases);
    }
}

#[test]
fn pyramids_have_their_corners_and_creases() {
    let found = worst(&pyramid(7.0, 8.0), false, rounds());
    assert!(found.corner < 1e-6 && found.creases > 0.99, "{} {}", found.corner, found.creases);
}

#[test]
fn wedges_keep_their_ridge() {
    let found = worst(&wedge(40.0, 9.0, 8.0), false, rounds());
    assert!(found.corner < 1e-6 && found.creases > 0.99, "{} {}", found.corner, found.creases);
}
