//! Bands of real offsets: OpenVDB's own checks, and Python against brute force.

use exocarp::internals::geom::triangle::Triangle;
use exocarp::internals::lattice::{Ijk, LEAF_SIZE, Lattice};
use exocarp::internals::vdb::write;
use exocarp::vdb::VdbOptions;
use exocarp::{
    BandOptions, Length, OffsetResult, OffsetSettings, RunSettings, TriMesh, VoxelSize, offset, shapes,
};
use std::fmt::Write as _;

fn level_set(mesh: &TriMesh, distance: f64, voxel: f64) -> OffsetResult {
    let settings = OffsetSettings {
        distance: Length::Units(distance),
        voxel: VoxelSize::Units(voxel),
        band: Some(BandOptions::default()),
        ..OffsetSettings::default()
    };
    offset(mesh, &settings, &run()).unwrap()
}

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

#[test]
fn smooth_offsets_pass_all_nine_checks() {
    for (mesh, distance) in [
        (shapes::sphere(16), 0.2),
        (shapes::sphere(16), -0.2),
        (shapes::torus(16), 0.1),
        (shapes::torus(16), -0.1),
        (shapes::cube(1), 0.5),
    ] {
        let band = level_set(&mesh, distance, 0.04).band.unwrap();
        assert_eq!(band.surface.check_level_set(&run()).unwrap(), Vec::<String>::new(), "{distance}");
    }
}

#[test]
fn all_offsets_pass_the_checks_but_the_gradient_at_creases() {
    for shape in shapes::ALL.iter().filter(|s| s.volume.is_some()) {
        for distance in [0.1, 0.0] {
            let band = level_set(&(shape.make)(4), distance, 0.06).band.unwrap();
            let failed = band.surface.check_level_set(&run()).unwrap();
            // Test 9 wants a gradient of about one on both sides of the surface. The exact distance
            // has kinks where the offset surface has creases, so it cannot hold there (nor does it
            // in level sets that OpenVDB makes of sharp models).
            let unexpected: Vec<&String> = failed.iter().filter(|m| !m.starts_with("test 9")).collect();
            assert!(unexpected.is_empty(), "{} {distance}: {unexpected:?}", shape.name);
        }
    }
}

#[test]
fn bands_are_level_sets_at_every_voxel_size() {
    // A box whose faces lie in planes of nodes, so that many nodes are at exactly three voxels; and
    // one that is turned.
    let turned = |mut mesh: TriMesh| {
        let rotation = glam::DQuat::from_axis_angle(glam::DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
        mesh.vertices.iter_mut().for_each(|v| *v = (rotation * glam::DVec3::from(*v)).to_array());
        mesh
    };
    let mut at_three_voxels = 0;
    for scale in [1e-3, 0.37, 1.0, 2048.0, 1e6 / 7.0] {
        for share in [0.25, 0.1, 1.0 / 3.0, 0.07] {
            for mesh in [shapes::cube(1), turned(shapes::cube(1))] {
                let vertices = mesh.vertices.iter().map(|v| v.map(|x| scale * x)).collect();
                let (mesh, voxel) = (TriMesh { vertices, ..mesh }, scale * share);
                let surface = level_set(&mesh, scale * 0.5, voxel).band.unwrap().surface;
                let what = format!("{scale} {share}");
                let failed = surface.check_level_set(&run()).unwrap();
                assert!(failed.iter().all(|message| message.starts_with("test 9")), "{what}: {failed:?}");
                let (background, count) = (surface.background(), surface.leaf_count());
                assert!(f64::from(background) > 3.0 * voxel, "{what}");
                let (mut values, mut active) = (vec![0.0; count * LEAF_SIZE], vec![[0; 8]; count]);
                surface.read_leaves(0, &mut values, &mut active).unwrap();
                for (n, phi) in values.iter().enumerate() {
                    let is_active = active[n / LEAF_SIZE][n % LEAF_SIZE / 64] >> (n % 64) & 1 == 1;
                    assert_eq!(is_active, phi.abs() < background, "{what}: {phi}");
                    assert!(is_active || phi.abs() == background, "{what}: {phi}");
                    at_three_voxels += u64::from(is_active && f64::from(phi.abs()) > 2.9999 * voxel);
                }
            }
        }
    }
    assert!(at_three_voxels > 1000, "{at_three_voxels}");
}

/// Signed distance by looking at every triangle: the smallest distance, negative where the
/// triangles' solid angles add up to a full turn.
fn brute_force(mesh: &TriMesh, p: [f64; 3]) -> f64 {
    let (mut nearest, mut turns) = (f64::INFINITY, 0.0);
    for (t, &vertices) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners(t).map(glam::DVec3::from);
        nearest = nearest.min(Triangle::new(corners, vertices).distance_squared(p.into()));
        let [a, b, c] = corners.map(|v| v - glam::DVec3::from(p));
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        turns += a.dot(b.cross(c)).atan2(denominator) / std::f64::consts::TAU;
    }
    if turns > 0.5 { -nearest.sqrt() } else { nearest.sqrt() }
}

mod needs_python {
    use super::*;

    #[test]
    #[ignore = "needs python3 with OpenVDB's module"]
    fn python_finds_the_distances_of_brute_force() {
        let (distance, voxel) = (0.12, 0.05);
        let mesh = shapes::carved_cube(4);
        let result = level_set(&mesh, distance, voxel);
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("carved.vdb");
        let options = VdbOptions { distance: Some(0.5), unit: Some("mm".into()), ..VdbOptions::default() };
        let band = result.band.as_ref().unwrap();
        write(&path, &band.surface, band.closest.as_ref(), &options).unwrap();

        // 1,000 random nodes of the model's surroundings.
        let mut state = 7u64;
        let mut random = |n: i32| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            ((state >> 33) % n as u64) as i32
        };
        let reach = (1.3 / voxel) as i32;
        let mut lines = String::new();
        for _ in 0..1000 {
            let node = Ijk(std::array::from_fn(|_| random(2 * reach + 1) - reach));
            let phi = brute_force(&mesh, Lattice { voxel }.world_from_index(node)) - distance;
            let [i, j, k] = node.0;
            writeln!(lines, "{i} {j} {k} {phi:e}").unwrap();
        }
        let nodes = dir.path().join("nodes.txt");
        std::fs::write(&nodes, lines).unwrap();
        let active = result.statistics.vdb.active_voxels.to_string();
        let paths = [path.to_str().unwrap(), "--nodes", nodes.to_str().unwrap()];
        let rest = ["--voxel", "0.05", "--half-width", "3", "--active", &active];
        let arguments = [&paths[..], &rest[..]].concat();
        let said = crate::needs_python::run("test_vdb.py", &arguments);
        assert!(said.contains("1000 random nodes"), "{said}");
    }
}
