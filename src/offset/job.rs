//! Identity of an offset, which tells its tiles from those of another: a number made of the input
//! and the settings.
//!
//! Machines that share nothing compare it, so it must be the same whatever compiler made the
//! program, and whatever the fields and types are called in the code. So each setting goes in under
//! a name and as bytes that are written down here.

use super::{OffsetSettings, OpenInput};
use crate::io::Tile;
use crate::mesh::TriMesh;
use crate::quantity::{Length, Precision, TileIndex, Tolerance, VoxelSize};

/// Returns the number of the offset of `mesh` with these settings, as this version of exocarp makes
/// it: two offsets with the same number are the same to the last bit.
///
/// Memory is left out, because it changes nothing of the result, and so is which grids are kept of
/// the band.
pub fn job(mesh: &TriMesh, settings: &OffsetSettings) -> u64 {
    of_version(env!("CARGO_PKG_VERSION"), mesh, settings)
}

impl Tile {
    /// Returns the identity of one tile of the offset of `mesh` with these settings.
    pub fn new(index: TileIndex, mesh: &TriMesh, settings: &OffsetSettings) -> Tile {
        Tile { index, job: job(mesh, settings) }
    }
}

fn of_version(version: &str, mesh: &TriMesh, settings: &OffsetSettings) -> u64 {
    // Named one by one, so that a new setting is not forgotten.
    let OffsetSettings {
        distance,
        voxel,
        open_input,
        #[cfg(feature = "openvdb")]
            band: _,
        precision,
        tolerance,
        max_halvings,
        max_memory: _,
    } = settings;
    let mut hash = Fnv1a::default();
    hash.text("version", version);
    match distance {
        Length::Units(d) => hash.number("distance in units", *d),
        Length::DiagonalFraction(share) => hash.number("distance of diagonal", *share),
    }
    match voxel {
        VoxelSize::Units(h) => hash.number("voxel in units", *h),
        VoxelSize::Resolution(n) => hash.integer("resolution", u64::from(*n)),
    }
    hash.text(
        "sign",
        match open_input {
            OpenInput::Refuse => "closed",
            OpenInput::Accept => "pseudonormal",
        },
    );
    hash.number("half width", settings.half_width());
    hash.text(
        "precision",
        match precision {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        },
    );
    match tolerance {
        None => {}
        Some(Tolerance::Units(t)) => hash.number("tolerance in units", *t),
        Some(Tolerance::Voxels(t)) => hash.number("tolerance in voxels", *t),
    }
    hash.integer("resolve", u64::from(*max_halvings));
    hash.integer("vertices", mesh.vertices.len() as u64);
    mesh.vertices.as_flattened().iter().for_each(|x| hash.bytes(&x.to_bits().to_le_bytes()));
    hash.integer("triangles", mesh.triangles.len() as u64);
    mesh.triangles.as_flattened().iter().for_each(|v| hash.bytes(&v.to_le_bytes()));
    hash.state
}

/// The hash FNV-1a of 64 bits (Fowler, Noll, Vo): it is defined by two constants, and quick enough
/// for meshes.
struct Fnv1a {
    state: u64,
}

impl Default for Fnv1a {
    fn default() -> Self {
        Fnv1a { state: 0xcbf2_9ce4_8422_2325 }
    }
}

impl Fnv1a {
    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.state = (self.state ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Names and texts end with a zero, so that no two lists of settings are the same bytes.
    fn name(&mut self, name: &str) {
        self.bytes(name.as_bytes());
        self.bytes(&[0]);
    }

    fn text(&mut self, name: &str, value: &str) {
        self.name(name);
        self.name(value);
    }

    fn number(&mut self, name: &str, value: f64) {
        self.name(name);
        self.bytes(&value.to_bits().to_le_bytes());
    }

    fn integer(&mut self, name: &str, value: u64) {
        self.name(name);
        self.bytes(&value.to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::BandOptions;
    use std::collections::BTreeSet;

    fn triangle() -> TriMesh {
        TriMesh {
            vertices: vec![[0.0, 0.25, -1.0], [1.0, 0.0, 0.1], [0.0, 1.0, 1e-9]],
            triangles: vec![[0, 1, 2]],
        }
    }

    #[test]
    fn the_hash_is_the_published_one() {
        // Test vectors of the authors.
        for (text, expected) in
            [("", 0xcbf2_9ce4_8422_2325u64), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            let mut hash = Fnv1a::default();
            hash.bytes(text.as_bytes());
            assert_eq!(hash.state, expected, "{text}");
        }
    }

    #[test]
    fn jobs_are_numbered_alike_by_every_compiler_and_release() {
        // Tiles carry these numbers: a change here means that tiles of before and after do not
        // join.
        let settings = OffsetSettings {
            distance: Length::DiagonalFraction(0.02),
            voxel: VoxelSize::Resolution(512),
            tolerance: Some(Tolerance::Voxels(0.05)),
            ..OffsetSettings::default()
        };
        assert_eq!(of_version("0.1.0", &triangle(), &settings), 0x1ff1_ad1b_0a6e_a08c);
        assert_eq!(of_version("0.1.0", &triangle(), &OffsetSettings::default()), 0x143e_3fc4_b16c_7e69);
    }

    #[test]
    fn whatever_changes_the_result_changes_the_number() {
        let settings = OffsetSettings::default();
        let with = |change: &dyn Fn(&mut OffsetSettings)| {
            let mut changed = settings.clone();
            change(&mut changed);
            job(&triangle(), &changed)
        };
        let mut moved = triangle();
        moved.vertices[1][2] = -0.1;
        let mut turned = triangle();
        turned.triangles[0] = [0, 2, 1];
        let all = [
            job(&triangle(), &settings),
            job(&moved, &settings),
            job(&turned, &settings),
            of_version("0.0.9", &triangle(), &settings),
            with(&|s| s.distance = Length::Units(0.02)),
            with(&|s| s.distance = Length::DiagonalFraction(-0.02)),
            with(&|s| s.voxel = VoxelSize::Units(0.1)),
            with(&|s| s.voxel = VoxelSize::Resolution(257)),
            with(&|s| s.open_input = OpenInput::Accept),
            with(&|s| s.band = Some(BandOptions::default())),
            with(&|s| s.precision = Precision::F64),
            with(&|s| s.tolerance = Some(Tolerance::Units(0.1))),
            with(&|s| s.tolerance = Some(Tolerance::Voxels(0.1))),
            with(&|s| s.max_halvings = 1),
        ];
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len(), "{all:x?}");
        let kept = |s: &mut OffsetSettings| {
            (s.max_memory, s.band) = (Some(1), Some(BandOptions { half_width: 1.0, closest: true }));
        };
        assert_eq!(with(&kept), all[0]);
    }
}
