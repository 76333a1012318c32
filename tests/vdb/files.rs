//! `.vdb` files written, read again, and damaged.

use crate::sphere::{Sphere, read_out};
use exocarp::RunSettings;
use exocarp::internals::vdb::{info, open_band, open_closest, open_surface, write};
use exocarp::vdb::{Compression, MetaValue, VdbError, VdbOptions, VdbPrecision};
use std::path::Path;

const SPHERE: Sphere = Sphere { radius: 2.0, voxel: 0.1, half_width: 3.0 };

/// Byte of a file's identifier that says of what kind it is.
const UUID_VERSION: usize = 21 + 14;

fn options() -> VdbOptions {
    VdbOptions {
        distance: Some(-0.25),
        unit: Some("mm".into()),
        metadata: vec![
            ("source".into(), MetaValue::Text("sphere".into())),
            ("triangles".into(), MetaValue::Integer(7)),
        ],
        ..VdbOptions::default()
    }
}

fn write_sphere(path: &Path, options: &VdbOptions) {
    let band = SPHERE.band();
    write(path, &band.surface, band.closest.as_ref(), options).unwrap();
}

#[test]
fn a_file_holds_the_band_bit_for_bit() {
    let dir = tempfile::tempdir().unwrap();
    let expected = read_out(&SPHERE.band());
    for compression in [Compression::Blosc, Compression::Zip, Compression::None] {
        // The extension is the caller's business.
        let path = dir.path().join(format!("{compression:?}.part"));
        write_sphere(&path, &VdbOptions { compression, ..options() });
        let band = open_band(&path).unwrap();
        assert_eq!(read_out(&band), expected);
        assert_eq!(band.surface.lattice(), SPHERE.lattice());
        assert_eq!(band.surface.translation(), [0.0; 3]);
        assert_eq!(band.surface.background().to_bits(), SPHERE.band().surface.background().to_bits());
        let run = RunSettings::with_threads(1).unwrap();
        assert_eq!(band.surface.check_level_set(&run).unwrap(), [""; 0]);
    }
}

#[test]
fn every_codec_compresses_a_level_set() {
    let dir = tempfile::tempdir().unwrap();
    let band = SPHERE.band();
    let run = RunSettings::with_threads(1).unwrap();
    for precision in [VdbPrecision::Full, VdbPrecision::Half] {
        let [blosc, zip, none] =
            [Compression::Blosc, Compression::Zip, Compression::None].map(|compression| {
                let path = dir.path().join(format!("{compression:?}-{precision:?}.vdb"));
                write(&path, &band.surface, None, &VdbOptions { compression, precision, ..options() })
                    .unwrap();
                let [grid] = &info(&path).unwrap().grids[..] else { panic!("not one grid") };
                // A level set in the file, however it is compressed, and the file says how.
                assert_eq!(grid.class, "level set", "{compression:?}");
                let said = grid.metadata.iter().find(|(name, _)| name == "file_compression").unwrap();
                let codec = format!("{compression:?}").to_lowercase().replace("none", "");
                assert!(said.1.starts_with(&codec) && said.1.ends_with("active values"), "{said:?}");
                assert_eq!(open_surface(&path, None).unwrap().check_level_set(&run).unwrap(), [""; 0]);
                std::fs::metadata(&path).unwrap().len()
            });
        assert!(zip < none, "{precision:?}: {blosc} {zip} {none}");
        // Of half floats, which are few bytes to a leaf, Blosc can make more than they were.
        assert!(precision == VdbPrecision::Half || blosc < none, "{blosc} {zip} {none}");
    }
}

#[test]
fn half_floats_keep_signs_and_stay_a_clean_level_set() {
    let dir = tempfile::tempdir().unwrap();
    // Voxel sizes whose background is rounded down by half floats, or is small for them.
    for voxel in [0.1, 0.07, 1.0 / 3.0, 1e-4, 1000.0] {
        let sphere = Sphere { voxel, radius: 20.0 * voxel, half_width: 3.0 };
        let (path, full) = (dir.path().join("half.vdb"), sphere.band());
        let precision = VdbPrecision::Half;
        write(&path, &full.surface, full.closest.as_ref(), &VdbOptions { precision, ..options() }).unwrap();
        let half = open_band(&path).unwrap();
        let run = RunSettings::with_threads(1).unwrap();
        assert_eq!(half.surface.check_level_set(&run).unwrap(), [""; 0], "h = {voxel}");
        let (a, b) = (read_out(&full), read_out(&half));
        assert_eq!((a.origins, a.active, a.ids), (b.origins, b.active, b.ids));
        for (a, b) in a.values.iter().zip(&b.values) {
            assert_eq!((*a < 0.0, *b != 0.0), (*b < 0.0, true), "{a} {b}");
            assert!((a - b).abs() <= full.surface.background() / 1024.0, "{a} {b}");
        }
    }
    let tiny = Sphere { voxel: 2e-5, radius: 2e-4, half_width: 3.0 }.band();
    let precision = VdbPrecision::Half;
    let options = VdbOptions { precision, ..options() };
    let error = write(&dir.path().join("tiny.vdb"), &tiny.surface, None, &options).unwrap_err();
    assert!(matches!(error, VdbError::Size { .. }), "{error}");
}

#[test]
fn a_file_says_what_it_holds() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sphere.vdb");
    write_sphere(&path, &options());
    let file = info(&path).unwrap();
    let meta = |name: &str| file.metadata.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str());
    assert_eq!(meta("offset_distance"), Some("-0.25"));
    assert_eq!(meta("voxel_size"), Some("0.1"));
    assert_eq!(meta("half_width"), Some("3"));
    assert_eq!(meta("unit"), Some("mm"));
    assert_eq!(meta("triangles"), Some("7"));
    assert!(meta("creator").unwrap().starts_with("exocarp "));

    let [surface, closest] = &file.grids[..] else { panic!("{file:?}") };
    assert_eq!((surface.name.as_str(), surface.value_type.as_str()), ("surface", "float"));
    assert_eq!((closest.name.as_str(), closest.value_type.as_str()), ("surface_closest", "int32"));
    assert_eq!((surface.class.as_str(), surface.background.as_str()), ("level set", "0.3"));
    assert_eq!(surface.active_voxels, SPHERE.band().surface.active_voxels());
    assert_eq!(surface.active_voxels, closest.active_voxels);
    let [low, high] = surface.index_bbox.unwrap();
    // The background is a hair above three voxels, so that nodes at exactly three are in the band.
    assert_eq!((low.0, high.0), ([-23; 3], [23; 3]));
    let [low, high] = surface.world_bbox.unwrap();
    assert!((0..3).all(|i| (low[i] + 2.3).abs() < 1e-12 && (high[i] - 2.3).abs() < 1e-12));
    // The statistics that viewers read from the header.
    let statistics = |name: &str| surface.metadata.iter().any(|(n, _)| n == name);
    assert!(
        ["file_bbox_min", "file_bbox_max", "file_voxel_count", "file_mem_bytes"].map(statistics) == [true; 4]
    );
}

#[test]
fn a_band_without_closest_triangles_opens() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("surface.vdb");
    let band = SPHERE.band();
    write(&path, &band.surface, None, &VdbOptions::default()).unwrap();
    assert!(open_band(&path).unwrap().closest.is_none());
    let error = open_closest(&path, None).unwrap_err();
    assert!(matches!(error, VdbError::MissingGrid { .. }), "{error}");
}

#[test]
fn a_missing_grid_is_named_with_those_that_exist() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sphere.vdb");
    write_sphere(&path, &options());
    let shown = path.display();
    let error = open_surface(&path, Some("density")).unwrap_err().to_string();
    let present = "it holds 'surface' (float), 'surface_closest' (int32)";
    assert_eq!(error, format!("{shown} has no float grid named 'density'; {present}"));
    let error = open_surface(&path, Some("surface_closest")).unwrap_err().to_string();
    assert_eq!(error, format!("{shown} has no float grid named 'surface_closest'; {present}"));
}

#[test]
fn what_is_no_vdb_file_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let missing = dir.path().join("missing.vdb");
    let error = open_surface(&missing, None).unwrap_err().to_string();
    assert_eq!(error, format!("cannot read {}: No such file or directory", missing.display()));
    let other = dir.path().join("other.vdb");
    for content in ["", "solid", "solid cube\nfacet normal 0 0 1\n"] {
        std::fs::write(&other, content).unwrap();
        let error = info(&other).unwrap_err().to_string();
        assert_eq!(error, format!("{} is not an OpenVDB file", other.display()));
    }
    assert!(matches!(open_surface(dir.path(), None), Err(VdbError::Read { .. })));
}

#[test]
fn the_same_band_is_the_same_file() {
    let dir = tempfile::tempdir().unwrap();
    let written = |name: &str, radius: f64| {
        let (path, band) = (dir.path().join(name), Sphere { radius, ..SPHERE }.band());
        write(&path, &band.surface, band.closest.as_ref(), &options()).unwrap();
        std::fs::read(&path).unwrap()
    };
    assert_eq!(written("a.vdb", 2.0), written("b.vdb", 2.0));
    assert_ne!(written("a.vdb", 2.0), written("b.vdb", 1.9));
}

#[test]
fn a_truncated_file_is_an_error_wherever_it_ends() {
    let dir = tempfile::tempdir().unwrap();
    let (path, cut) = (dir.path().join("sphere.vdb"), dir.path().join("cut.vdb"));
    write_sphere(&path, &options());
    let own = std::fs::read(&path).unwrap();
    // With a random identifier, as other programs write it, there is no hash that tells.
    let mut foreign = own.clone();
    foreign[UUID_VERSION] = b'4';
    std::fs::write(&path, &foreign).unwrap();
    assert!(open_surface(&path, None).is_ok());
    for whole in [own, foreign] {
        // Every third end in the header, and some hundred in the trees.
        let ends = (8..1500)
            .step_by(3)
            .chain((1500..whole.len()).step_by(whole.len() / 300))
            .chain([whole.len() - 1]);
        for end in ends {
            std::fs::write(&cut, &whole[..end]).unwrap();
            let error = open_surface(&cut, None).unwrap_err();
            assert!(matches!(error, VdbError::Read { .. }), "{end}: {error}");
            assert!(!error.to_string().contains('\n'), "{end}: {error}");
            assert!(info(&cut).is_err());
        }
    }
}

#[test]
fn a_damaged_file_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sphere.vdb");
    write_sphere(&path, &options());
    let whole = std::fs::read(&path).unwrap();
    for place in (8..whole.len()).step_by(997).filter(|&n| n != UUID_VERSION) {
        let mut damaged = whole.clone();
        damaged[place] ^= 0x10;
        std::fs::write(&path, damaged).unwrap();
        let error = open_surface(&path, None).unwrap_err().to_string();
        assert!(error.ends_with("the file is damaged or incomplete"), "{place}: {error}");
    }
}

#[test]
fn what_cannot_be_written_is_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let band = SPHERE.band();
    let path = dir.path().join("no/such/dir.vdb");
    let error = write(&path, &band.surface, None, &options()).unwrap_err().to_string();
    assert_eq!(error, format!("cannot write {}: No such file or directory", path.display()));
    assert!(write(dir.path(), &band.surface, None, &options()).is_err());
    let device = Path::new("/dev/null");
    if device.exists() {
        let error = write(device, &band.surface, None, &options()).unwrap_err().to_string();
        assert_eq!(error, "cannot write /dev/null: it is not a regular file");
    }
}

/// Name of the variable that makes the next test write, in a process that may not write much.
const OUTPUT: &str = "EXOCARP_TEST_OUTPUT";

#[test]
#[cfg(target_os = "linux")]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    if let Some(path) = std::env::var_os(OUTPUT) {
        let error = write(Path::new(&path), &SPHERE.band().surface, None, &options()).unwrap_err();
        assert!(error.to_string().ends_with("File too large"), "{error}");
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sphere.vdb");
    write_sphere(&path, &options());
    let old = std::fs::read(&path).unwrap();
    // Files of at most 8 KiB, or 16 where the shell counts in KiB; the signal would end the
    // process.
    let limited = "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\"";
    let test = "files::a_failed_write_leaves_the_old_file_and_nothing_else";
    let run = std::process::Command::new("sh")
        .args(["-c", limited])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", test])
        .env(OUTPUT, &path)
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success() && printed.contains("1 passed"), "{printed}");
    assert!(old.len() > 16 << 10);
    assert_eq!(std::fs::read(&path).unwrap(), old);
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
}
