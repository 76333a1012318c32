//! Offsets of random small meshes at random settings: each ends soon, sound or with a reason. With
//! `EXOCARP_HEAVY=1` two thousand of them.

mod common;

use common::random::Random;
use common::small_meshes::{KINDS, small_mesh};
use exocarp::internals::io::load;
use exocarp::io::{SaveOptions, save};
use exocarp::verify::soundness;
use exocarp::{Precision, RunSettings};
use std::path::Path;
use std::process::{Command, Stdio};

/// Limits of a run: seconds of CPU, and bytes of address space, of which it uses less than
/// half.
const CPU_SECONDS: u32 = 5;
const ADDRESS_SPACE_KIB: u32 = 1_000_000;

/// Peak memory that a run may have.
const MOST_BYTES: u64 = 500_000_000;

/// The settings of run number `n`, as options.
fn options(random: &mut Random) -> Vec<String> {
    let mut options = Vec::new();
    let mut add = |words: &[&str]| options.extend(words.iter().map(|w| (*w).to_owned()));
    let size = random.log_within(-9.0..3.0);
    let distance = match random.below(5) {
        0 => "0".to_owned(),
        1 | 2 => format!("{size:e}%"),
        _ => format!("-{size:e}%"),
    };
    add(&[&format!("--distance={distance}")]);
    add(&["--resolution", &(1 + random.below(33)).to_string()]);
    if random.one_in(2) {
        add(&["--sign", "pseudonormal"]);
    }
    if random.one_in(4) {
        add(&["--tolerance", &format!("{:e}h", random.log_within(-2.0..0.0))]);
    }
    match random.below(6) {
        0 => add(&["--resolve=2"]),
        1 => add(&["--stream"]),
        2 => add(&["--tile", &format!("{}/3", 1 + random.below(3))]),
        _ => {}
    }
    if random.one_in(4) {
        add(&["--f64"]);
    }
    options
}

/// Offsets mesh number `n` in a process with limits. Returns what was wrong.
fn offset(n: u64, directory: &Path) -> Result<&'static str, String> {
    let mut random = Random(n);
    let kind = (n % KINDS.len() as u64) as usize;
    let mesh = small_mesh(kind, &mut random);
    let [input, output, stats] =
        ["in.off", "out.ply", "out.json"].map(|name| directory.join(format!("{n}-{name}")));
    save(&mesh, &input, &SaveOptions { precision: Precision::F64 }).map_err(|e| e.to_string())?;
    let options = options(&mut random);
    let line = format!("{} {n}: offset {}", KINDS[kind], options.join(" "));
    let limits = format!("ulimit -t {CPU_SECONDS} -v {ADDRESS_SPACE_KIB}; exec \"$0\" \"$@\"");
    let ended = Command::new("bash")
        .args(["-c", &limits, env!("CARGO_BIN_EXE_exocarp"), "offset"])
        .arg(&input)
        .args(&options)
        .args(["--threads", "2", "--quiet", "-o"])
        .arg(&output)
        .arg("--stats")
        .arg(&stats)
        .stdin(Stdio::null())
        .output()
        .map_err(|e| e.to_string())?;
    let text = String::from_utf8_lossy(&ended.stderr).into_owned();
    match ended.status.code() {
        Some(0) => {}
        Some(2..=5) if text.lines().count() == 1 => return Ok("refused"),
        code => return Err(format!("{line}: exit code {code:?}: {text}")),
    }
    let facts: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&stats).unwrap()).unwrap();
    if facts["peak_rss"].as_u64().is_none_or(|bytes| bytes > MOST_BYTES) {
        return Err(format!("{line}: took {} bytes", facts["peak_rss"]));
    }
    if options.iter().any(|option| option == "--tile") {
        return Ok("made a tile");
    }
    let mesh = load(&output).map_err(|e| format!("{line}: {e}"))?;
    let run = RunSettings::with_threads(2).map_err(|e| e.to_string())?;
    let broken = soundness(&mesh, &run).map_err(|e| e.to_string())?.broken();
    if broken.is_empty() { Ok("sound") } else { Err(format!("{line}: {broken:?}")) }
}

#[test]
fn small_meshes_end_soon_sound_or_with_a_reason() {
    let is_heavy = std::env::var_os("EXOCARP_HEAVY").is_some_and(|v| v == "1");
    let count = if is_heavy { 2_000 } else { 150 };
    let directory = tempfile::tempdir().unwrap();
    let (mut done, mut wrong) = (std::collections::BTreeMap::new(), Vec::new());
    // One run again, with what is left in ./out: EXOCARP_SMALL_MESH=35.
    let one = std::env::var("EXOCARP_SMALL_MESH").ok().and_then(|n| n.parse().ok());
    if let Some(n) = one {
        std::fs::create_dir_all("out").unwrap();
        eprintln!("{:?}", offset(n, Path::new("out")));
        return;
    }
    for n in 0..count {
        match offset(n, directory.path()) {
            Ok(how) => *done.entry(how).or_insert(0) += 1,
            Err(error) => {
                eprintln!("{error}");
                wrong.push(error);
            }
        }
    }
    eprintln!("{done:?}");
    assert!(wrong.is_empty(), "{} of {count}: {wrong:#?}", wrong.len());
    // Neither may be rare: else the meshes or the settings are not what they should be.
    assert!(done["sound"] > count / 4 && done["refused"] > count / 50, "{done:?}");
}
