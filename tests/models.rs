//! The models of the models directory load, clean up and survive a round trip through every format.
//! The directory is `EXOCARP_MODELS`, or `../shared/models` beside the crate.

use std::path::PathBuf;

use exocarp::io::{SaveOptions, load, save};
use exocarp::mesh::clean;
use exocarp::quantity::Precision;

/// The models with their numbers of triangles in the file.
const MODELS: [(&str, usize); 17] = [
    ("anchor_dense.off", 7598),
    ("armadillo.obj", 86482),
    ("blobby_3cc.off", 3417),
    ("bunny00.off", 75408),
    ("cheese.off", 17786),
    ("cow.obj", 5804),
    ("dragon.ply", 871414),
    ("elephant-with-holes.off", 4463),
    ("elephant.obj", 12064),
    ("face.obj", 51712),
    ("fandisk.obj", 12946),
    ("head.off", 2918),
    ("knot1.off", 6400),
    ("lion.off", 16674),
    ("patch-01.off", 1396),
    ("rocker-arm.obj", 20088),
    ("teapot.obj", 6320),
];

fn models() -> PathBuf {
    let default = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/models");
    std::env::var_os("EXOCARP_MODELS").map_or_else(default, PathBuf::from)
}

#[test]
fn each_model_loads_and_comes_back_from_every_format() {
    let directory = tempfile::tempdir().unwrap();
    for (name, triangles) in MODELS {
        let path = models().join(name);
        if !path.exists() {
            eprintln!("skipped: {name} (no file {})", path.display());
            continue;
        }
        let raw = load(&path).unwrap();
        assert_eq!(raw.triangles.len(), triangles, "{name}");
        let (mesh, report) = clean(raw);
        eprintln!("{name}: {report}");
        assert!(!mesh.triangles.is_empty(), "{name}");
        assert!(clean(mesh.clone()).1.is_clean(), "{name}");

        // The largest model would only take long.
        let extensions: &[&str] = if triangles > 100_000 { &["ply"] } else { &["ply", "obj", "off"] };
        for extension in extensions {
            let copy = directory.path().join(name).with_extension(extension);
            save(&mesh, &copy, &SaveOptions { precision: Precision::F64 }).unwrap();
            let again = load(&copy).unwrap();
            assert_eq!(again.triangles, mesh.triangles, "{}", copy.display());
            let single = |v: &[f64; 3]| v.map(|x| x as f32);
            assert!(again.vertices.iter().map(single).eq(mesh.vertices.iter().map(single)));
        }
        let copy = directory.path().join("copy.stl");
        mesh.save(&copy).unwrap();
        let (_, report) = clean(load(&copy).unwrap());
        assert!(report.welded_vertices >= 3 * mesh.triangles.len() - mesh.vertices.len(), "{name}");
    }
}
