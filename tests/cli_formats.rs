//! One result in every format: equal coordinates, whoever reads them.

mod common;

use common::exocarp;
use exocarp::internals::io::load;
use exocarp::io::{SaveOptions, save};
use exocarp::verify::soundness;
use exocarp::{Precision, RunSettings, TriMesh, clean, shapes};
use std::path::{Path, PathBuf};

/// A patch of 2 x 2 squares that is bent like a pillow.
fn pillow() -> TriMesh {
    let heights = [0.0, 1.9, 2.05, 1.9, 2.05, 0.31, 2.05, 0.31, -1.7];
    let vertices =
        heights.iter().enumerate().map(|(n, &z)| [11.3 * (n / 3) as f64, 11.3 * (n % 3) as f64, z]);
    let squares = [0u32, 1, 3, 4].map(|a| [[a, a + 3, a + 4], [a, a + 4, a + 1]]);
    TriMesh { vertices: vertices.collect(), triangles: squares.as_flattened().to_vec() }
}

/// Whether every coordinate is an f32.
fn is_single(mesh: &TriMesh) -> bool {
    mesh.vertices.as_flattened().iter().all(|&x| f64::from(x as f32) == x)
}

#[track_caller]
fn assert_sound(mesh: &TriMesh, what: &str) {
    let run = RunSettings::with_threads(2).unwrap();
    let broken = soundness(&clean(mesh.clone()).0, &run).unwrap().broken();
    assert!(broken.is_empty(), "{what}: {broken:?}");
}

/// The coordinates in a text file, word by word, as a reader of 32 bits takes them.
fn singles(path: &Path) -> Vec<f32> {
    let text = std::fs::read_to_string(path).unwrap();
    let vertices: Vec<&str> = match path.extension().unwrap().to_str().unwrap() {
        "obj" => text.lines().filter_map(|line| line.strip_prefix("v ")).collect(),
        // The keyword, the counts, and then vertices up to the first face, which begins with the
        // number of its corners.
        _ => text.lines().skip(2).take_while(|line| line.split(' ').count() == 3).collect(),
    };
    vertices.iter().flat_map(|line| line.split(' ')).map(|word| word.parse().unwrap()).collect()
}

#[test]
fn every_command_writes_the_same_coordinates_into_every_format() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let text = |path: &PathBuf| path.display().to_string();
    // Patches whose coordinates 32 bits do not hold.
    let mut wave = (shapes::by_name("wave").unwrap().make)(4);
    wave.vertices.iter_mut().flatten().for_each(|x| *x /= 3.0);
    for (mesh, name) in [(pillow(), "pillow.ply"), (wave, "wave.ply")] {
        save(&mesh, &at(name), &SaveOptions { precision: Precision::F64 }).unwrap();
    }
    let (pillow, wave) = (text(&at("pillow.ply")), text(&at("wave.ply")));
    let commands: [(&str, Vec<&str>); 4] = [
        ("pillow", vec!["offset", &pillow, "-d", "0", "--resolution", "8", "--sign", "pseudonormal"]),
        ("offset", vec!["offset", &wave, "-d", "10%", "--resolution", "24", "--sign", "pseudonormal"]),
        ("thicken", vec!["thicken", &wave, "-t", "12%"]),
        ("model", vec!["model", "sphere", "--detail", "6"]),
    ];
    for (name, command) in commands {
        for wide in [false, true] {
            let write = |extension: &str| {
                let path = at(&format!("{name}-{wide}.{extension}"));
                let more = if wide { &["--f64"][..] } else { &[] };
                let output = text(&path);
                let outcome = exocarp(&[&command[..], &["-o", &output], more].concat());
                assert_eq!(outcome.code, 0, "{name} {extension}: {outcome:?}");
                (load(&path).unwrap(), path)
            };
            let (ply, _) = write("ply");
            assert_eq!(is_single(&ply), !wide, "{name}");
            if name != "model" {
                assert_sound(&ply, name);
            }
            for extension in ["obj", "off"] {
                let (mesh, path) = write(extension);
                assert!(mesh == ply, "{name} {extension} {wide}: not the coordinates of PLY");
                if !wide {
                    let expected = ply.vertices.as_flattened().iter().map(|&x| x as f32);
                    assert!(singles(&path).into_iter().eq(expected), "{name} {extension}: read as 32 bits");
                }
            }
        }
    }
}
