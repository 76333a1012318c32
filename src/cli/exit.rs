//! How the program ends: exit codes, and which error means which.

use exocarp::compare::CompareError;
use exocarp::contour::ContourError;
use exocarp::error::Error;
use exocarp::io::{MergeProblem, SaveProblem};
use exocarp::thicken::ThickenError;
use exocarp::vdb::VdbError;
use exocarp::verify::VerifyError;
use std::io::ErrorKind;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Exit {
    /// Something that must not happen, or a write that failed.
    Internal = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// The input cannot be used.
    Input = 3,
    /// The result would be empty.
    Empty = 4,
    /// Memory, disk or a number does not suffice.
    Limit = 5,
    /// `verify` found that a mesh breaks a promise.
    Broken = 6,
    /// Ctrl-C, or the signal to terminate.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}

/// Why a command failed, and how the program ends.
#[derive(Debug)]
pub(super) struct Failure {
    pub exit: Exit,
    /// One sentence: which file or element, what is wrong, what to do.
    pub sentence: String,
}

impl Failure {
    pub fn new(exit: Exit, sentence: impl Into<String>) -> Self {
        Failure { exit, sentence: sentence.into() }
    }

    /// Wrong use of the command line.
    pub fn usage(sentence: impl Into<String>) -> Self {
        Failure::new(Exit::Usage, sentence)
    }

    /// Says on stderr what happened, unless the interrupt handler has said it already.
    pub fn report(self) -> ExitCode {
        if self.exit == Exit::Interrupted {
            say_interrupted();
        } else {
            say("error", &self.sentence);
        }
        self.exit.into()
    }
}

/// One line on stderr.
pub(super) fn say(kind: &str, sentence: &str) {
    use std::io::Write;
    // Nobody is left to be told when stderr is closed.
    let _ = writeln!(std::io::stderr(), "exocarp: {kind}: {}", sentence.replace('\n', " "));
}

/// Says that the run was interrupted, once: the interrupted command and the signal handler may both get here.
pub(super) fn say_interrupted() {
    static SAID: AtomicBool = AtomicBool::new(false);
    if !SAID.swap(true, Ordering::SeqCst) {
        say("error", "interrupted; no file was written");
    }
}

impl<E: Into<Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        let error = error.into();
        let mut sentence = error.to_string();
        if matches!(error, Error::Vdb(VdbError::Write { .. })) {
            sentence += "; check the permissions and the free space";
        }
        Failure::new(of(&error), sentence)
    }
}

/// Which error means which exit.
fn of(error: &Error) -> Exit {
    match error {
        Error::Cancelled(_) => Exit::Interrupted,
        Error::Settings(_) | Error::Verify(VerifyError::Setting { .. }) => Exit::Usage,
        Error::Load(_) | Error::Input(_) | Error::Verify(_) => Exit::Input,
        Error::Empty(_) => Exit::Empty,
        Error::Compare(CompareError::Setting(_)) => Exit::Usage,
        Error::Compare(CompareError::Temporary(e)) => of_io(e),
        Error::Thicken(ThickenError::Patch(_)) => Exit::Input,
        Error::Thicken(ThickenError::Obstacle { .. }) => Exit::Limit,
        Error::Thicken(_) => Exit::Usage,
        Error::Memory(_) | Error::TooManyEdges(_) | Error::Threads(_) => Exit::Limit,
        Error::Contour(ContourError::Cancelled(_)) => Exit::Interrupted,
        Error::Contour(_) => Exit::Limit,
        Error::Save(error) => match &error.problem {
            SaveProblem::Extension(_) => Exit::Usage,
            SaveProblem::Create(e) | SaveProblem::Write(e) | SaveProblem::Replace(e) => of_io(e),
            SaveProblem::Coordinate { .. } | SaveProblem::TooManyTriangles => Exit::Limit,
            _ => Exit::Internal,
        },
        Error::Merge(error) => match &error.problem {
            MergeProblem::Write(e) => of_io(e),
            MergeProblem::TooLarge => Exit::Limit,
            MergeProblem::Empty => Exit::Empty,
            _ => Exit::Input,
        },
        Error::Vdb(error) => match error {
            VdbError::Cancelled(_) => Exit::Interrupted,
            VdbError::Read { .. }
            | VdbError::NotVdb { .. }
            | VdbError::MissingGrid { .. }
            | VdbError::Unsuitable { .. } => Exit::Input,
            VdbError::Size { .. } => Exit::Limit,
            VdbError::Write { reason, .. } if is_full(reason) => Exit::Limit,
            _ => Exit::Internal,
        },
        _ => Exit::Internal,
    }
}

/// Whether this is what the system says of a full disk. OpenVDB hands on the text alone.
fn is_full(reason: &str) -> bool {
    /// Beyond the last number of an error of any system.
    const NUMBERS: i32 = 256;
    (1..NUMBERS).map(std::io::Error::from_raw_os_error).any(|error| {
        of_io(&error) == Exit::Limit && error.to_string().split(" (os error").next() == Some(reason)
    })
}

/// A write that failed: a full disk is a limit, anything else is not foreseen.
pub(super) fn of_io(error: &std::io::Error) -> Exit {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => Exit::Limit,
        _ => Exit::Internal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_known_by_its_name() {
        assert!(
            is_full("No space left on device") && is_full("Disk quota exceeded") && is_full("File too large")
        );
        assert!(!is_full("Permission denied") && !is_full(""));
    }
}
