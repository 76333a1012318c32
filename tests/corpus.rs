//! The corpus: each bug of the past is a small input with the facts that are expected of it.
//!
//! `corpus/index.json` lists the cases. A case has an `input` (a file of the folder, or a generated
//! model), a command to `run`, the exit `code`, and what standard error `says`, nothing if nothing
//! is listed. A case with exit code 0 makes a mesh, which must be sound; `output` has more facts of
//! it, `statistics` has values of the statistics file by JSON pointer. `meant` has facts that a
//! right result would have and today's has not: when that is mended, the case fails here, and
//! `meant` becomes `output`.

mod common;

use common::exocarp;
use exocarp::internals::io::load;
use exocarp::internals::mesh::Topology;
use exocarp::internals::mesh::measure::signed_volume;
use exocarp::verify::soundness;
use exocarp::{RunSettings, TriMesh, clean};
use rayon::prelude::*;
use serde::Deserialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Seconds of CPU after which a run is ended. Each takes a second or less.
const CPU_SECONDS: u32 = 30;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Case {
    name: String,
    why: String,
    input: Input,
    run: String,
    code: i32,
    says: Vec<String>,
    output: Option<Facts>,
    meant: Option<Facts>,
    #[serde(default)]
    statistics: BTreeMap<String, Value>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Input {
    File(String),
    Model { model: String, detail: u32 },
}

/// Facts of a mesh; those that are not given are not looked at.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Facts {
    /// The least and the largest volume.
    volume: Option<[f64; 2]>,
    /// The least and the largest number of triangles.
    triangles: Option<[usize; 2]>,
    /// The number of connected parts of the surface.
    pieces: Option<usize>,
    /// The number of handles of all parts together.
    handles: Option<i64>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus")
}

fn cases() -> Vec<Case> {
    serde_json::from_str(&std::fs::read_to_string(folder().join("index.json")).unwrap()).unwrap()
}

/// Returns the path of a case's input, which may be made in `directory`.
fn input(case: &Case, directory: &Path) -> String {
    match &case.input {
        Input::File(name) => folder().join(name).display().to_string(),
        Input::Model { model, detail } => {
            let path = directory.join(format!("{model}.ply")).display().to_string();
            let made = exocarp(&["model", model, "--detail", &detail.to_string(), "-o", &path]);
            assert_eq!(made.code, 0, "{made:?}");
            path
        }
    }
}

/// Returns how a mesh differs from facts; nothing if it does not.
fn differences(mesh: &TriMesh, facts: &Facts) -> Vec<String> {
    let mut all = Vec::new();
    let volume = signed_volume(mesh);
    if facts.volume.is_some_and(|[least, most]| volume < least || most < volume) {
        all.push(format!("the volume is {volume}"));
    }
    let triangles = mesh.triangles.len();
    if facts.triangles.is_some_and(|[least, most]| triangles < least || most < triangles) {
        all.push(format!("there are {triangles} triangles"));
    }
    let pieces = Topology::new(mesh).components();
    if facts.pieces.is_some_and(|expected| pieces != expected) {
        all.push(format!("there are {pieces} pieces"));
    }
    let vertices: BTreeSet<u32> = mesh.triangles.as_flattened().iter().copied().collect();
    // Euler's formula for closed surfaces: V - F / 2 = 2 (pieces - handles).
    let handles = pieces as i64 - (vertices.len() as i64 - triangles as i64 / 2) / 2;
    if facts.handles.is_some_and(|expected| handles != expected) {
        all.push(format!("there are {handles} handles"));
    }
    all
}

/// Returns what is wrong with the mesh that a case made.
fn check_output(case: &Case, output: &Path) -> Result<Vec<String>, String> {
    let mesh = clean(load(output).map_err(|e| e.to_string())?).0;
    let run = RunSettings::with_threads(1).map_err(|e| e.to_string())?;
    let mut wrong: Vec<String> = soundness(&mesh, &run)
        .map_err(|e| e.to_string())?
        .broken()
        .iter()
        .map(|b| format!("{b:?}"))
        .collect();
    wrong.extend(case.output.iter().flat_map(|facts| differences(&mesh, facts)));
    if case.meant.as_ref().is_some_and(|facts| differences(&mesh, facts).is_empty()) {
        wrong.push("the result is what is meant: make it the expected one".to_owned());
    }
    Ok(wrong)
}

/// Runs a case. Returns what is wrong.
fn run(case: &Case) -> Result<Vec<String>, String> {
    let directory = tempfile::tempdir().map_err(|e| e.to_string())?;
    let [output, statistics] = ["out.ply", "out.json"].map(|name| directory.path().join(name));
    let limits = format!("ulimit -t {CPU_SECONDS}; exec \"$0\" \"$@\"");
    let mut words = case.run.split_whitespace();
    let ended = Command::new("bash")
        .args(["-c", &limits, env!("CARGO_BIN_EXE_exocarp")])
        .args(words.next())
        .arg(input(case, directory.path()))
        .args(words)
        .args(["--threads", "1", "-o"])
        .arg(&output)
        .arg("--stats")
        .arg(&statistics)
        .stdin(Stdio::null())
        .output()
        .map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&ended.stderr).into_owned();
    let mut wrong = Vec::new();
    if ended.status.code() != Some(case.code) {
        return Err(format!("exit code {:?}: {said}", ended.status.code()));
    }
    wrong.extend(
        case.says.iter().filter(|part| !said.contains(*part)).map(|p| format!("{p:?} is not in: {said}")),
    );
    if said.is_empty() != case.says.is_empty() {
        wrong.push(format!("it says: {said}"));
    }
    if case.code != 0 {
        wrong.extend(output.exists().then(|| "there is an output".to_owned()));
        return Ok(wrong);
    }
    wrong.extend(check_output(case, &output)?);
    let text = std::fs::read_to_string(&statistics).map_err(|e| e.to_string())?;
    let found: Value = serde_json::from_str(&text).map_err(|e| e.to_string())?;
    for (pointer, value) in &case.statistics {
        if found.pointer(pointer) != Some(value) {
            wrong.push(format!("{pointer} is {:?}", found.pointer(pointer)));
        }
    }
    Ok(wrong)
}

#[test]
fn each_case_has_the_facts_that_are_expected() {
    let check = |case: &Case| match run(case) {
        Ok(wrong) if wrong.is_empty() => None,
        Ok(wrong) => Some(format!("{}: {}", case.name, wrong.join("; "))),
        Err(error) => Some(format!("{}: {error}", case.name)),
    };
    let wrong: Vec<String> = cases().par_iter().filter_map(check).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn the_index_names_each_file_and_each_case_once() {
    let cases = cases();
    assert!(cases.len() > 40, "{}", cases.len());
    let names: BTreeSet<&str> = cases.iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names.len(), cases.len());
    assert!(cases.iter().all(|case| case.why.ends_with('.')));
    assert!(cases.iter().all(|case| case.code == 0 || (case.output.is_none() && case.meant.is_none())));
    let files: BTreeSet<String> =
        common::names(&folder()).into_iter().filter(|n| n != "index.json").collect();
    let used: BTreeSet<String> = cases
        .iter()
        .filter_map(|case| match &case.input {
            Input::File(name) => Some(name.clone()),
            Input::Model { .. } => None,
        })
        .collect();
    assert_eq!(files, used);
}
