//! Thickened patches: the same bytes in scalar code as in the machine's vectors, and cancelled in
//! each phase.

use super::{PatchSide, ThickenError, ThickenSettings, thicken};
use crate::geom::simd::scalar::in_vectors_and_scalars;
use crate::mesh::{TriMesh, shapes};
use crate::quantity::Length;
use crate::run::{CancelToken, Phase, Progress, RunSettings};
use glam::{DQuat, DVec3};
use std::sync::Arc;

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

/// Turns a mesh so that nothing lies in the lattice's planes.
fn turned(mut mesh: TriMesh) -> TriMesh {
    let rotation = DQuat::from_axis_angle(DVec3::new(2.0, -1.0, 3.0).normalize(), 0.8);
    for v in &mut mesh.vertices {
        *v = (rotation * DVec3::from(*v) + DVec3::new(0.1, -0.2, 0.3)).to_array();
    }
    mesh
}

#[test]
fn thickened_patches_are_the_same_in_scalar_code() {
    for (name, patch) in [("wave", shapes::wave(12)), ("turned wave", turned(shapes::wave(12)))] {
        for side in [PatchSide::Inner, PatchSide::Outer] {
            let settings = ThickenSettings {
                thickness: Length::DiagonalFraction(0.03),
                side,
                ..ThickenSettings::default()
            };
            let what = format!("{name} {side:?}");
            let [in_vectors, in_scalars] =
                in_vectors_and_scalars(|| thicken(&patch, &settings, &run()).expect(&what).mesh);
            assert!(in_vectors.triangles.len() > 2 * patch.triangles.len(), "{what}");
            assert!(in_vectors.triangles == in_scalars.triangles, "{what}: the triangles differ");
            let bits = |mesh: &TriMesh| -> Vec<[u64; 3]> {
                mesh.vertices.iter().map(|v| v.map(f64::to_bits)).collect()
            };
            assert!(bits(&in_vectors) == bits(&in_scalars), "{what}: the vertices differ");
        }
    }
}

/// Cancels a run when one of its phases begins.
struct CancelAt {
    phase: Phase,
    cancel: CancelToken,
}

impl Progress for CancelAt {
    fn begin(&self, phase: Phase, _: u64) {
        if phase == self.phase {
            self.cancel.cancel();
        }
    }

    fn advance(&self, _: Phase, _: u64) {}

    fn end(&self, _: Phase) {}
}

#[test]
fn a_cancelled_run_says_so_in_each_phase() {
    let (open, closed) = (shapes::wave(12), shapes::cube(4));
    for patch in [&open, &closed] {
        for phase in [Phase::Hierarchy, Phase::Band, Phase::Edges, Phase::Contour] {
            let cancel = CancelToken::default();
            let progress = Arc::new(CancelAt { phase, cancel: cancel.clone() });
            let run = run().with_cancel(cancel).with_progress(progress);
            let made = thicken(patch, &ThickenSettings::default(), &run);
            assert!(matches!(made, Err(ThickenError::Cancelled)), "{phase:?}: {made:?}");
        }
    }
}
