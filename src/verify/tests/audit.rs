//! The judge as the tests of other rooms call it.

use crate::mesh::TriMesh;
use crate::run::RunSettings;
use crate::verify::{Soundness, soundness};
use std::sync::LazyLock;

/// One thread: most meshes of the tests are small, and the tests themselves run in parallel.
static RUN: LazyLock<RunSettings> = LazyLock::new(|| RunSettings::with_threads(1).unwrap());

/// Topology and intersections.
pub(crate) fn audit(mesh: &TriMesh) -> Soundness {
    soundness(mesh, &RUN).unwrap()
}
