//! The judge of thickened patches.

use exocarp::internals::mesh::measure::signed_volume;
use exocarp::verify::soundness;
use exocarp::{PatchSide, RunSettings, ThickenResult, ThickenSettings, TriMesh, thicken};
use std::collections::BTreeSet;

/// Thickens, and checks everything that is promised.
#[track_caller]
pub fn check(patch: &TriMesh, settings: &ThickenSettings) -> ThickenResult {
    let run = RunSettings::with_threads(2).unwrap();
    let result = thicken(patch, settings, &run).unwrap();
    audit(patch, settings, &result);
    result
}

/// Checks everything that is promised of a result.
#[track_caller]
pub fn audit(patch: &TriMesh, settings: &ThickenSettings, result: &ThickenResult) {
    let run = RunSettings::with_threads(2).unwrap();
    let report = soundness(&result.mesh, &run).unwrap();
    assert!(report.broken().is_empty(), "{:?}", report.broken());
    let there: BTreeSet<_> = (0..result.mesh.triangles.len()).map(|t| corners(&result.mesh, t)).collect();
    let mut turned = patch.clone();
    turned.vertices.iter_mut().for_each(|v| *v = v.map(|x| settings.precision.round(x)));
    if settings.side == PatchSide::Outer {
        turned.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    for t in 0..patch.triangles.len() {
        assert!(there.contains(&corners(&turned, t)), "triangle {t} is lost");
    }
    assert!(signed_volume(&result.mesh) > 0.0);
}

/// The bits of a triangle's corners, in its direction, from the least one on.
fn corners(mesh: &TriMesh, t: usize) -> [[u64; 3]; 3] {
    let mut corners = mesh.corners(t).map(|v| v.map(|x| (x + 0.0).to_bits()));
    let first = (0..3).min_by_key(|&k| corners[k]).unwrap();
    corners.rotate_left(first);
    corners
}
