//! Equal bytes of every output for every number of threads, over the settings of the program.

mod common;

use common::{exocarp, names};
use std::collections::BTreeMap;
use std::path::Path;

/// A model with its detail, and a command without the names of its outputs.
const RUNS: [(&str, &str, &str, &[&str]); 9] = [
    ("carved_cube", "6", "offset -d 4% --resolution 32 --tolerance 0.05h", &["ply", "vdb"]),
    ("anchor", "6", "offset -d -1% --resolution 48 --vdb-compression none", &["ply", "vdb"]),
    ("bracket", "6", "offset -d 0.2 --voxel 0.1 --resolve", &["off"]),
    ("wave", "8", "offset -d 3% --resolution 40 --sign pseudonormal --closest", &["ply", "vdb"]),
    ("linked_tori", "16", "offset -d 2% --resolution 48 --f64 --tolerance 0.2h", &["ply"]),
    ("carved_cube", "16", "offset -d -2% --resolution 64 --stream", &["stl"]),
    ("carved_cube", "6", "offset -d 2% --resolution 48 --tile 2/3", &["ply", "vdb"]),
    ("flower", "8", "offset -d 2% --resolution 48", &["vdb"]),
    ("wave", "12", "thicken -t 4%", &["ply", "vdb"]),
];

/// Returns the bytes of what a run writes, by name.
fn outputs(input: &str, run: &str, extensions: &[&str], threads: &str) -> BTreeMap<String, Vec<u8>> {
    let directory = tempfile::tempdir().unwrap();
    let path = |extension: &str| directory.path().join(format!("out.{extension}")).display().to_string();
    let mut words: Vec<String> = run.split_whitespace().map(str::to_owned).collect();
    words.insert(1, input.to_owned());
    for &extension in extensions {
        words.extend([if extension == "vdb" { "--vdb" } else { "-o" }.to_owned(), path(extension)]);
    }
    words.extend(["--threads", threads, "--quiet"].map(str::to_owned));
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let outcome = exocarp(&words);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    let read = |name: String| (name.clone(), std::fs::read(directory.path().join(name)).unwrap());
    names(directory.path()).into_iter().map(read).collect()
}

fn model(directory: &Path, name: &str, detail: &str) -> String {
    let path = directory.join(format!("{name}.ply")).display().to_string();
    assert_eq!(exocarp(&["model", name, "-o", &path, "--detail", detail]).code, 0);
    path
}

#[test]
fn every_output_has_the_same_bytes_for_every_number_of_threads() {
    let directory = tempfile::tempdir().unwrap();
    for (name, detail, run, extensions) in RUNS {
        let input = model(directory.path(), name, detail);
        let one = outputs(&input, run, extensions, "1");
        assert_eq!(one.len(), extensions.len(), "{run}");
        assert!(one.values().all(|bytes| bytes.len() > 10_000), "{run}");
        for threads in ["2", "4"] {
            let more = outputs(&input, run, extensions, threads);
            assert!(one.keys().eq(more.keys()), "{run}");
            for (output, bytes) in &one {
                assert!(*bytes == more[output], "{name}: {run}: {output} differs with {threads} threads");
            }
        }
    }
}
