//! Thickened patches of the public test models, from the directory `EXOCARP_MODELS`. With
//! `EXOCARP_HEAVY=1` both sides, two thicknesses and two resolutions of all.

mod common;

use common::models::path;
use common::thickened::check;
use exocarp::internals::io::load;
use exocarp::internals::mesh::Topology;
use exocarp::{Length, PatchSide, ThickenSettings, TriMesh, VoxelSize, clean};
use std::collections::BTreeSet;

const PATCHES: [&str; 5] = ["head.off", "patch-01.off", "elephant-with-holes.off", "lion.off", "face.obj"];

fn patch(name: &str) -> TriMesh {
    clean(load(&path(name)).unwrap()).0
}

fn mean_edge(mesh: &TriMesh) -> f64 {
    let edges: BTreeSet<[u32; 2]> =
        mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).map(sorted).collect();
    let at = |v: u32| glam::DVec3::from(mesh.vertices[v as usize]);
    edges.iter().map(|&[a, b]| at(a).distance(at(b))).sum::<f64>() / edges.len() as f64
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn check_at(name: &str, patch: &TriMesh, side: PatchSide, edges: f64, resolution: u32) {
    let settings = ThickenSettings {
        thickness: Length::Units(edges * mean_edge(patch)),
        voxel: Some(VoxelSize::Resolution(resolution)),
        side,
        ..ThickenSettings::default()
    };
    let result = check(patch, &settings);
    // The rim alone has one for each edge of the boundary.
    let boundary = Topology::new(patch).defects().boundary_edges;
    assert!(boundary > 0 && result.statistics.triangles.new > boundary as u64, "{name}");
    eprintln!("{name} {side:?} {edges} {resolution}: {:?}", result.statistics.triangles);
}

mod needs_models {
    use super::*;

    #[test]
    #[ignore = "needs the test models (EXOCARP_MODELS)"]
    fn small_patches_become_sound_solids() {
        for name in &PATCHES[..3] {
            check_at(name, &patch(name), PatchSide::Inner, 2.5, 128);
        }
    }
}

mod long {
    mod needs_models {
        use super::super::*;

        #[test]
        #[ignore = "takes minutes, and needs the test models (EXOCARP_HEAVY=1, EXOCARP_MODELS)"]
        fn every_patch_becomes_a_sound_solid_on_both_sides() {
            for name in PATCHES {
                let patch = patch(name);
                for side in [PatchSide::Inner, PatchSide::Outer] {
                    for edges in [2.5, 5.0] {
                        for resolution in [128, 256] {
                            check_at(name, &patch, side, edges, resolution);
                        }
                    }
                }
            }
        }
    }
}
