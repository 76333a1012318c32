//! Thickened patches of the models directory: `EXOCARP_MODELS`, or `../shared/models` beside the
//! crate. With `EXOCARP_HEAVY=1` both sides, two thicknesses and two resolutions of all.

mod common;

use common::thickened::check;
use exocarp::io::load;
use exocarp::mesh::{TriMesh, clean};
use exocarp::quantity::{Length, VoxelSize};
use exocarp::thicken::{Side, ThickenSettings};
use std::collections::BTreeSet;
use std::path::PathBuf;

const PATCHES: [&str; 5] = ["head.off", "patch-01.off", "elephant-with-holes.off", "lion.off", "face.obj"];

/// The patch, if its file is there; says so if not.
fn patch(name: &str) -> Option<TriMesh> {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    let path = std::env::var_os("EXOCARP_MODELS").map_or_else(default, PathBuf::from).join(name);
    if !path.exists() {
        eprintln!("skipped: {name} (no file {})", path.display());
        return None;
    }
    Some(clean(load(&path).unwrap()).0)
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

fn check_at(name: &str, patch: &TriMesh, side: Side, edges: f64, resolution: u32) {
    let settings = ThickenSettings {
        thickness: Length::Units(edges * mean_edge(patch)),
        voxel: Some(VoxelSize::Resolution(resolution)),
        side,
        ..ThickenSettings::default()
    };
    let result = check(patch, &settings);
    assert!(result.statistics.triangles.new > 0);
    eprintln!("{name} {side:?} {edges} {resolution}: {:?}", result.statistics.triangles);
}

#[test]
fn small_patches_become_sound_solids() {
    for name in &PATCHES[..3] {
        let Some(patch) = patch(name) else { continue };
        check_at(name, &patch, Side::Inner, 2.5, 128);
    }
}

#[test]
fn every_patch_becomes_a_sound_solid_on_both_sides() {
    if std::env::var_os("EXOCARP_HEAVY").is_none_or(|v| v != "1") {
        eprintln!("skipped: {PATCHES:?} at all settings (EXOCARP_HEAVY=1 runs them)");
        return;
    }
    for name in PATCHES {
        let Some(patch) = patch(name) else { continue };
        for side in [Side::Inner, Side::Outer] {
            for edges in [2.5, 5.0] {
                for resolution in [128, 256] {
                    check_at(name, &patch, side, edges, resolution);
                }
            }
        }
    }
}
