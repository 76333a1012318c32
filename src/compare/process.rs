//! Processes: one per measurement, so that its memory is its own and its crash is nobody else's.

use super::measurement::Measurement;
use super::worker::Job;
use super::{CompareError, Method, Needs};
use crate::run::RunSettings;
use serde::Serialize;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// The programs that run the methods.
#[derive(Clone, Debug)]
pub struct Programs {
    /// A program that does a [`Job`] with [`work`](super::work) when called with
    /// [`worker_arguments`].
    pub worker: PathBuf,
    /// The Python interpreter for MeshLib's methods.
    pub python: PathBuf,
}

/// Why there is no measurement.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Lost {
    /// The process took longer than this many seconds.
    TimedOut(u64),
    /// The process ended by a signal, with this number.
    Crashed(i32),
    /// The process said what failed.
    Failed(String),
}

impl std::fmt::Display for Lost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Lost::TimedOut(seconds) => write!(f, "not finished after {seconds} s"),
            Lost::Crashed(signal) => write!(f, "crashed (signal {signal})"),
            Lost::Failed(reason) => write!(f, "failed: {reason}"),
        }
    }
}

/// The script that MeshLib's methods run.
const MESHLIB: &str = include_str!("meshlib.py");

/// Time between two looks at a process: also the delay of an interrupt.
const POLL: Duration = Duration::from_millis(10);

/// Importing the package takes a second; a disk that is asleep may take ten.
const PROBE_LIMIT: Duration = Duration::from_secs(60);

/// The hidden subcommand of the program that does a [`Job`].
pub const WORKER: &str = "compare-worker";

/// The arguments with which a program is asked to do a job.
pub fn worker_arguments(job: &Job, threads: usize) -> Vec<OsString> {
    let text = |s: String| OsString::from(s);
    vec![
        WORKER.into(),
        job.method.name().into(),
        job.input.clone().into(),
        // The shortest text that reads back as the same number.
        text(format!("{:e}", job.distance)),
        text(format!("{:e}", job.voxel)),
        job.output.clone().into(),
        "--threads".into(),
        text(threads.to_string()),
    ]
}

/// Whether MeshLib can be imported; otherwise the sentence that says why its methods are left out.
///
/// # Errors
/// [`CompareError::Cancelled`].
pub fn probe_meshlib(python: &Path, run: &RunSettings) -> Result<Result<(), String>, CompareError> {
    let shown = python.display();
    let absent = format!(
        "MeshLib is left out: {shown} cannot import the package meshlib (pip install meshlib, or name an \
         interpreter that has it with --python)"
    );
    let mut command = Command::new(python);
    command.args(["-c", "import meshlib.mrmeshpy"]);
    match execute(command, PROBE_LIMIT, run) {
        Ok(ended) if ended.status.success() => Ok(Ok(())),
        Ok(_) | Err(Halt::TimedOut) => Ok(Err(absent)),
        Err(Halt::NotStarted(error)) => {
            Ok(Err(format!("MeshLib is left out: {shown} cannot be started ({error})")))
        }
        Err(Halt::Cancelled) => Err(CompareError::Cancelled),
    }
}

/// Does one job in a process of its own.
///
/// # Errors
/// [`CompareError::Cancelled`], and [`CompareError::Start`] when there is no process at all.
pub fn measure(
    job: &Job,
    programs: &Programs,
    limit: Duration,
    run: &RunSettings,
) -> Result<Result<Measurement, Lost>, CompareError> {
    let (program, arguments) = match job.method.needs() {
        Needs::Nothing => (&programs.worker, worker_arguments(job, run.threads())),
        Needs::Meshlib => {
            let arguments = serde_json::json!({
                "method": job.method.name(),
                "input": job.input,
                "distance": job.distance,
                "voxel": job.voxel,
                "output": job.output,
                "threads": run.threads(),
            });
            (&programs.python, vec!["-c".into(), MESHLIB.into(), arguments.to_string().into()])
        }
    };
    let mut command = Command::new(program);
    command.args(arguments);
    match execute(command, limit, run) {
        Ok(ended) => Ok(judge(&ended, job.method)),
        Err(Halt::TimedOut) => Ok(Err(Lost::TimedOut(limit.as_secs()))),
        Err(Halt::Cancelled) => Err(CompareError::Cancelled),
        Err(Halt::NotStarted(source)) => Err(CompareError::Start { program: program.clone(), source }),
    }
}

fn judge(ended: &Ended, method: Method) -> Result<Measurement, Lost> {
    if let Some(signal) = signal(ended.status) {
        return Err(Lost::Crashed(signal));
    }
    // Errors end with their cause: Python's traceback as well as our own single line.
    let reason = ended.stderr.lines().rev().map(str::trim).find(|line| !line.is_empty());
    if !ended.status.success() {
        let reason = reason.unwrap_or("it gave no reason");
        return Err(Lost::Failed(reason.trim_start_matches("exocarp: error: ").into()));
    }
    match Measurement::from_output(&ended.stdout) {
        Some(measurement) if measurement.method == method => Ok(measurement),
        _ => Err(Lost::Failed("it printed no measurement".into())),
    }
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}

struct Ended {
    status: ExitStatus,
    stdout: String,
    stderr: String,
}

enum Halt {
    NotStarted(std::io::Error),
    TimedOut,
    Cancelled,
}

/// Runs a command to its end, or kills it when its time is up or the run is cancelled.
fn execute(mut command: Command, limit: Duration, run: &RunSettings) -> Result<Ended, Halt> {
    // Files, not pipes: nobody has to read while the process writes.
    let (out, err) = (file()?, file()?);
    let copy = |f: &std::fs::File| f.try_clone().map_err(Halt::NotStarted);
    let child = command.stdin(Stdio::null()).stdout(copy(&out)?).stderr(copy(&err)?).spawn();
    let mut child = Running(child.map_err(Halt::NotStarted)?);
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.0.try_wait().map_err(Halt::NotStarted)? {
            break status;
        }
        if run.check().is_err() {
            return Err(Halt::Cancelled);
        }
        if started.elapsed() > limit {
            return Err(Halt::TimedOut);
        }
        std::thread::sleep(POLL);
    };
    Ok(Ended { status, stdout: content(out), stderr: content(err) })
}

/// A child that does not outlive its handle.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // Fails when it has ended, which is what we want.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn file() -> Result<std::fs::File, Halt> {
    tempfile::tempfile().map_err(Halt::NotStarted)
}

fn content(mut file: std::fs::File) -> String {
    use std::io::{Read, Seek};
    let mut bytes = Vec::new();
    // What cannot be read back says nothing, and a process that said nothing is told so.
    let _ = file.rewind().and_then(|()| file.read_to_end(&mut bytes));
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::run::CancelToken;

    /// A script, written by a process of its own: a file that this one holds open for writing while
    /// another test starts a process could not be executed.
    fn script(directory: &Path, text: &str) -> PathBuf {
        let path = directory.join("peer.sh");
        let write = r#"printf '#!/bin/sh\n%s\n' "$1" > "$2" && chmod +x "$2""#;
        let wrote = Command::new("sh").args(["-c", write, "sh", text]).arg(&path).status().unwrap();
        assert!(wrote.success());
        path
    }

    fn outcome(text: &str, limit: Duration) -> Result<Measurement, Lost> {
        let directory = tempfile::tempdir().unwrap();
        let worker = script(directory.path(), text);
        let job = Job {
            method: Method::Exocarp,
            input: "in.ply".into(),
            distance: -0.1,
            voxel: 0.01,
            output: "out.ply".into(),
        };
        let run = RunSettings::with_threads(1).unwrap();
        measure(&job, &Programs { worker, python: "python3".into() }, limit, &run).unwrap()
    }

    const LONG: Duration = Duration::from_secs(30);

    #[test]
    fn a_line_of_json_is_a_measurement() {
        let line = r#"echo hello; echo '{"method":"exocarp","engine":1.5,"triangles":9}'; echo bye"#;
        assert_eq!(outcome(line, LONG).unwrap().engine, 1.5);
        let other = r#"echo '{"method":"openvdb-wide","engine":1.5,"triangles":9}'"#;
        assert!(matches!(outcome(other, LONG), Err(Lost::Failed(_))));
    }

    #[test]
    fn losses_say_what_happened() {
        assert_eq!(outcome("kill -SEGV $$", LONG), Err(Lost::Crashed(11)));
        let failed = outcome("echo one >&2; echo 'exocarp: error: no voxels' >&2; exit 4", LONG).unwrap_err();
        assert_eq!(failed.to_string(), "failed: no voxels");
        assert_eq!(outcome("exec sleep 60", Duration::from_millis(50)), Err(Lost::TimedOut(0)));
        assert!(matches!(outcome("exit 0", LONG), Err(Lost::Failed(_))));
    }

    #[test]
    fn a_missing_package_is_one_sentence() {
        let directory = tempfile::tempdir().unwrap();
        let run = RunSettings::with_threads(1).unwrap();
        let python = script(directory.path(), "echo ModuleNotFoundError >&2; exit 1");
        let sentence = probe_meshlib(&python, &run).unwrap().unwrap_err();
        assert!(sentence.contains("peer.sh") && sentence.contains("--python"), "{sentence}");
        let sentence = probe_meshlib(&directory.path().join("none"), &run).unwrap().unwrap_err();
        assert!(sentence.contains("cannot be started"), "{sentence}");
    }

    #[test]
    fn cancelling_kills_the_process() {
        let cancel = CancelToken::default();
        let run = RunSettings::with_threads(1).unwrap().with_cancel(cancel.clone());
        cancel.cancel();
        let mut command = Command::new("sleep");
        command.arg("60");
        assert!(matches!(execute(command, LONG, &run), Err(Halt::Cancelled)));
    }

    #[test]
    fn numbers_cross_exactly() {
        let job = Job {
            method: Method::Exocarp,
            input: "a b.ply".into(),
            distance: -0.1 - 0.2,
            voxel: 1.0 / 3.0,
            output: "o".into(),
        };
        let arguments = worker_arguments(&job, 2);
        assert_eq!(arguments[3].to_str().unwrap().parse::<f64>(), Ok(job.distance));
        assert_eq!(arguments[4].to_str().unwrap().parse::<f64>(), Ok(job.voxel));
    }
}
