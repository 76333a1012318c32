//! Slabs against the whole: the same mesh, the same band, the same counts.

use exocarp::internals::lattice::LEAF_SIZE;
use exocarp::vdb::Band;
use exocarp::{
    BandOptions, Length, MeshChunk, MeshSink, OffsetError, OffsetResult, OffsetSettings, OpenInput,
    Partition, Precision, RunSettings, StreamResult, TileIndex, Tolerance, TriMesh, VoxelSize, offset,
    offset_streamed, shapes,
};
use std::error::Error;

fn run() -> RunSettings {
    RunSettings::with_threads(2).unwrap()
}

/// Puts the pieces together.
#[derive(Default)]
struct Gathered(TriMesh);

impl MeshSink for Gathered {
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.0 = TriMesh::default();
        Ok(())
    }

    fn chunk(&mut self, chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
        // Of a tile, only the numbers beside one another count.
        let first = self.0.vertices.len() as i64 - chunk.first_vertex() as i64;
        self.0.vertices.extend_from_slice(chunk.vertices());
        let number = |v: u64| u32::try_from(first + v as i64).unwrap();
        self.0.triangles.extend(chunk.triangles().map(|t| t.map(number)));
        Ok(())
    }
}

fn settings(distance: f64, voxel: f64) -> OffsetSettings {
    OffsetSettings {
        distance: Length::Units(distance),
        voxel: VoxelSize::Units(voxel),
        precision: Precision::F64,
        ..OffsetSettings::default()
    }
}

fn rotated(mut mesh: TriMesh) -> TriMesh {
    let rotation = glam::DQuat::from_axis_angle(glam::DVec3::new(1.0, -2.0, 0.5).normalize(), 0.9);
    for v in &mut mesh.vertices {
        *v = (rotation * glam::DVec3::from(*v)).to_array();
    }
    mesh
}

/// Six times as long along x.
fn stretched(mut mesh: TriMesh) -> TriMesh {
    for v in &mut mesh.vertices {
        v[0] *= 6.0;
    }
    mesh
}

/// Origins, values and active masks, and the inside in between.
fn content(band: &Band) -> (Vec<exocarp::internals::lattice::Ijk>, Vec<u32>, Vec<[u64; 8]>, Vec<bool>) {
    let origins = band.surface.leaf_origins();
    let mut values = vec![0.0; origins.len() * LEAF_SIZE];
    let mut active = vec![[0; 8]; origins.len()];
    band.surface.read_leaves(0, &mut values, &mut active).unwrap();
    let grid: Vec<_> = (0..40 * 40 * 40)
        .map(|n| {
            exocarp::internals::lattice::Ijk::new(
                8 * (n / 1600 - 20),
                8 * (n / 40 % 40 - 20),
                8 * (n % 40 - 20),
            )
        })
        .collect();
    (origins, values.into_iter().map(f32::to_bits).collect(), active, band.surface.inside_at(&grid))
}

/// A little more than the thinnest slabs take: those of one layer would be many.
fn little_memory(mesh: &TriMesh, settings: &OffsetSettings) -> u64 {
    match offset_streamed(mesh, settings, Partition::Memory(1), &mut Gathered::default(), &run()) {
        Err(OffsetError::Memory(error)) => error.needed + error.needed / 20,
        // Nothing is cut where no surface is.
        _ => 1,
    }
}

fn assert_same(slabs: &StreamResult, whole: &OffsetResult, what: &str) {
    let (s, w) = (&slabs.statistics, &whole.statistics);
    assert_eq!((s.filter, s.edges, s.contour), (w.filter, w.edges, w.contour), "{what}");
    assert_eq!(s.missed, w.missed, "{what}");
    assert_eq!((s.vdb.leaves, s.vdb.active_voxels), (w.vdb.leaves, w.vdb.active_voxels), "{what}");
    let (s, w) = (slabs.band.as_ref().map(content), whole.band.as_ref().map(content));
    assert!(s == w, "{what}: the bands differ");
}

#[test]
fn slabs_one_after_the_other_give_the_whole() {
    for (name, mesh) in [
        ("flower", stretched(rotated(shapes::flower(8)))),
        ("carved_cube", stretched(rotated(shapes::carved_cube(6)))),
        ("box", stretched(shapes::cube(1))),
    ] {
        for distance in [0.1, -0.06] {
            for tolerance in [None, (name == "carved_cube").then_some(Tolerance::Voxels(0.02))] {
                let settings = OffsetSettings {
                    tolerance,
                    band: Some(BandOptions::default()),
                    // So many layers that a halo is not all of them.
                    ..settings(distance, if tolerance.is_some() { 0.02 } else { 0.035 })
                };
                let what = format!("{name} {distance} {tolerance:?}");
                let whole = offset(&mesh, &settings, &run()).unwrap();
                let mut pieces = Gathered::default();
                let cut = Partition::Memory(little_memory(&mesh, &settings));
                let slabs = offset_streamed(&mesh, &settings, cut, &mut pieces, &run()).unwrap();
                assert!(slabs.statistics.slabs > 1, "{what}: {}", slabs.statistics.slabs);
                assert!(pieces.0 == whole.mesh, "{what}: the meshes differ");
                assert_same(&slabs, &whole, &what);
            }
        }
    }
}

/// Gathers the pieces of one tile after those of another.
struct Continued<'a>(&'a mut Gathered);

impl MeshSink for Continued<'_> {
    fn restart(&mut self) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }

    fn chunk(&mut self, chunk: &MeshChunk) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.0.chunk(chunk)
    }
}

/// The meshes of all tiles, one after the other.
fn in_tiles(mesh: &TriMesh, settings: &OffsetSettings, of: u32) -> TriMesh {
    let mut all = Gathered::default();
    for number in 1..=of {
        let cut = Partition::Tile(TileIndex::new(number, of).unwrap());
        offset_streamed(mesh, settings, cut, &mut Continued(&mut all), &run()).unwrap();
    }
    all.0
}

#[test]
fn tiles_one_after_the_other_give_the_whole() {
    let mesh = rotated(shapes::anchor(6));
    let settings = settings(0.05, 0.012);
    let whole = offset(&mesh, &settings, &run()).unwrap();
    for of in [2, 5, 40] {
        assert!(in_tiles(&mesh, &settings, of) == whole.mesh, "{of} tiles: the meshes differ");
    }
}

/// A mesh turned inside out: everything far away is solid, and the result ends
/// where the lattice does.
fn inside_out(mut mesh: TriMesh) -> TriMesh {
    mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    mesh
}

#[test]
fn inside_out_models_in_slabs_and_tiles_give_the_whole() {
    let mut without_surface = 0;
    for (name, mesh) in [
        ("box", inside_out(shapes::cube(1))),
        ("sphere", inside_out(rotated(shapes::sphere(6)))),
        ("linked_tori", inside_out(stretched(rotated(shapes::linked_tori(8))))),
    ] {
        // The last distances are larger than the hollow is deep: no surface is left but the end of
        // the lattice.
        for (distance, voxel) in [(0.0, 0.2), (-0.3, 0.11), (2.5, 0.4), (9.0, 0.9)] {
            let settings = OffsetSettings {
                open_input: OpenInput::Accept,
                band: Some(BandOptions::default()),
                ..settings(distance, voxel)
            };
            let what = format!("{name} {distance}");
            let whole = offset(&mesh, &settings, &run()).unwrap();
            assert!(whole.statistics.edges.sign_jumps > 0, "{what}");
            without_surface += u32::from(whole.statistics.vdb.active_voxels == 0);
            for of in [2, 5] {
                let tiles = in_tiles(&mesh, &settings, of);
                assert!(tiles == whole.mesh, "{what}: the meshes of {of} tiles differ");
            }
            let mut pieces = Gathered::default();
            let memory = Partition::Memory(little_memory(&mesh, &settings));
            let slabs = offset_streamed(&mesh, &settings, memory, &mut pieces, &run()).unwrap();
            assert!(pieces.0 == whole.mesh, "{what}: the mesh in slabs differs");
            assert_same(&slabs, &whole, &what);
        }
    }
    assert!(without_surface > 2, "{without_surface}");
}
