//! Every option with values that no one should give: each run ends by itself, with an exit code
//! that says why, and never with that of an internal error. With `EXOCARP_HEAVY=1` many more
//! values.

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use common::exocarp;

/// Values for every option, whatever it takes.
const VALUES: [&str; 8] = ["0", "-1", "nan", "inf", "1e308", "1e-300", "", "4294967295"];

/// More of them, for the long run.
const MORE_VALUES: [&str; 26] = [
    "-0",
    "-inf",
    "-1e308",
    "-1e-300",
    "5e-324",
    " ",
    "1e9",
    "1e-9",
    "1e-20",
    "4294967296",
    "18446744073709551615",
    "99999999999999999999",
    "0%",
    "-100%",
    "1e308%",
    "1e-300%",
    "nan%",
    "0x10",
    "1,5",
    "½",
    "1h",
    "1e-300h",
    "1e308h",
    "1/2",
    "--",
    "1",
];

/// A command that works in the directory of [`Bench`], and its options.
struct Case {
    command: &'static [&'static str],
    options: &'static [&'static str],
}

const CASES: [Case; 6] = [
    Case {
        command: &["offset", "box.ply", "-d=0.1", "--resolution=12", "--vdb=o.vdb", "-o=o.ply"],
        options: &[
            "-d",
            "--voxel",
            "--resolution",
            "--tolerance",
            "--resolve",
            "--tile",
            "--threads",
            "--max-memory",
            "--sign",
            "--vdb",
            "--stats",
            "-o",
            "--vdb-compression",
            "--unit",
        ],
    },
    Case {
        command: &["thicken", "wave.ply", "-t=0.2", "-o=t.ply"],
        options: &[
            "-t",
            "--voxel",
            "--resolution",
            "--resolve",
            "--rounds",
            "--side",
            "--section-normals",
            "--thickness-map",
        ],
    },
    Case {
        command: &["verify", "box.ply", "box.ply", "-d=0", "--samples=100"],
        options: &["-d", "--voxel", "--tolerance", "--samples", "--seed", "--shell", "--sign", "--json"],
    },
    Case {
        command: &["compare", "box.ply", "-d=0.1", "--resolution=8", "--runs=1", "--methods=exocarp"],
        // Lengths are those of an offset.
        options: &["--resolution", "--runs", "--timeout", "--once-above", "--methods"],
    },
    Case {
        command: &["paper", "--table=1", "--resolution=8"],
        options: &["--table", "--resolution", "--models"],
    },
    Case { command: &["model", "box", "-o=m.ply"], options: &["--detail", "-o"] },
];

/// More that makes no sense, or not together.
const SINGLE: [&[&str]; 35] = [
    &["compare", "box.ply", "-d=0.1", "--methods=meshlib-sharp", "--python=nothing"],
    &["offset", "box.ply", "-d=-0.9999", "--resolution=4", "--resolve=10", "-o=o.ply"],
    &["offset", "box.ply", "-d=0", "--resolution=1", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "--tile=1/4294967295", "-o=o.ply"],
    &[
        "offset",
        "box.ply",
        "-d=0.1",
        "--resolution=12",
        "--tile=4294967295/4294967295",
        "-o=o.stl",
        "--vdb=o.vdb",
    ],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "--tile=1/2", "--stream", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "--tile=1/2", "--resolve", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "--stream", "--max-memory=1", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "--max-memory=1e308T", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=1000000", "--max-memory=1e18", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=100000", "--stream", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=100000", "--tile=1/1000", "-o=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.ply", "--vdb=o.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.stl", "--f64"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "--vdb=o.vdb", "--f64"],
    &["offset", "box.ply", "-d=1e5", "--voxel=3e4", "--vdb=o.vdb", "--half"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.ply", "--tolerance=1e-7h"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.off", "--tolerance=1e-15"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.ply", "--tolerance=1e308h"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.ply", "--threads=513"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=o.ply", "-q", "-v"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=box.ply/x.ply"],
    &["offset", "box.ply", "-d=0.1", "--resolution=12", "-o=box.ply", "--stats=./box.ply"],
    &["verify", "box.ply", "box.ply", "-d=0", "--samples=20000001"],
    &["verify", "box.ply", "box.ply", "-d=-1e308", "--samples=100"],
    &["verify", "box.ply", "box.ply", "-d=0", "--shell", "--samples=100"],
    &["thicken", "wave.ply", "-t=1e-9", "-o=t.ply"],
    &["thicken", "wave.ply", "-t=0.2", "--rounds=1000", "-o=t.ply"],
    &["thicken", "wave.ply", "-t=0.2", "--resolution=100000", "-o=t.ply"],
    &["thicken", "wave.ply", "-t=0.2", "--thickness-map=box.ply", "-o=t.ply"],
    &["thicken", "box.ply", "-t=10", "-o=t.ply"],
    &["compare", "box.ply", "-d=0.1", "--resolution=8", "--report=box.ply"],
    &["compare", "box.ply", "-d=-5", "--resolution=8", "--runs=1", "--methods=exocarp"],
    &["merge", "box.ply", "-o=box.ply"],
    &["info", ""],
];

/// A directory with inputs, where outputs of any name may be left.
struct Bench(tempfile::TempDir);

/// Longer than any of these runs takes, on a busy machine too: what is stopped then would not have
/// ended.
const PATIENCE: Duration = Duration::from_secs(120);

impl Bench {
    fn new() -> Bench {
        let dir = tempfile::tempdir().unwrap();
        for (name, detail) in [("box", "2"), ("wave", "2")] {
            let path = dir.path().join(format!("{name}.ply"));
            assert_eq!(exocarp(&["model", name, "-o", path.to_str().unwrap(), "--detail", detail]).code, 0);
        }
        Bench(dir)
    }

    /// Runs the program in the directory, with 8 GB of memory.
    fn run(&self, arguments: &[String]) -> Output {
        let mut child = Command::new("sh")
            .args(["-c", "ulimit -v 8388608 && exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_exocarp")])
            .args(arguments)
            .current_dir(self.0.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let started = Instant::now();
        while child.try_wait().unwrap().is_none() {
            if started.elapsed() > PATIENCE {
                child.kill().unwrap();
                panic!("{arguments:?} does not end");
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        child.wait_with_output().unwrap()
    }

    /// Runs the program and checks how it ends.
    fn check(&self, arguments: &[String]) -> i32 {
        let output = self.run(arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        let code = output.status.code().unwrap_or(-1);
        assert!([0, 2, 3, 4, 5, 6].contains(&code), "{arguments:?}: {code}, {stderr}");
        let errors = stderr.lines().filter(|line| line.starts_with("exocarp: error: ")).count();
        let warnings = stderr.lines().filter(|line| line.starts_with("exocarp: warning: ")).count();
        assert_eq!((errors, errors + warnings), (usize::from(code != 0), stderr.lines().count()), "{stderr}");
        code
    }

    /// No run leaves what it has not completed.
    fn check_names(&self) {
        let hidden = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().starts_with(".exocarp-");
        let left: Vec<PathBuf> =
            fs::read_dir(self.0.path()).unwrap().map(|e| e.unwrap().path()).filter(hidden).collect();
        assert!(left.is_empty(), "{left:?}");
    }
}

/// A command with another value of an option.
fn with(command: &[&str], option: &str, value: &str) -> Vec<String> {
    let is_other = |argument: &&&str| {
        let name = argument.split('=').next().unwrap();
        // One of the two is given.
        name != option
            && !(option == "--voxel" && name == "--resolution")
            && !(option == "--thickness-map" && name == "-t")
    };
    let kept = command.iter().filter(is_other).map(|a| a.to_string());
    kept.chain([format!("{option}={value}")]).collect()
}

/// All runs, by two threads.
fn check_all(runs: &[Vec<String>]) {
    let bench = Bench::new();
    let next = AtomicUsize::new(0);
    let done: Vec<i32> = std::thread::scope(|scope| {
        let work = || {
            let take = || runs.get(next.fetch_add(1, Ordering::Relaxed));
            std::iter::from_fn(take).map(|run| bench.check(run)).collect::<Vec<i32>>()
        };
        let workers = [scope.spawn(work), scope.spawn(work)];
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    bench.check_names();
    // Neither was everything refused, nor did everything work.
    assert!(done.contains(&0) && done.contains(&2), "{done:?}");
    assert!(Path::new(&bench.0.path().join("box.ply")).exists());
}

#[test]
#[cfg(unix)]
fn every_option_with_any_value() {
    let is_heavy = std::env::var_os("EXOCARP_HEAVY").is_some_and(|v| v == "1");
    let more: &[&str] = if is_heavy { &MORE_VALUES } else { &[] };
    let mut runs = Vec::new();
    for Case { command, options } in CASES {
        for option in options {
            let values = VALUES.iter().chain(more);
            runs.extend(values.map(|value| with(command, option, value)));
        }
    }
    check_all(&runs);
}

#[test]
#[cfg(unix)]
fn options_that_make_no_sense_together() {
    let runs = SINGLE.map(|run| run.iter().map(|a| a.to_string()).collect::<Vec<String>>());
    check_all(&runs);
}
