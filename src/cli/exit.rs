//! Exit codes, and the error that each stands for.

use exocarp::internals::compare::CompareError;
use exocarp::internals::paper::PaperError;
use exocarp::io::{LoadError, MergeError, MergeErrorKind, SaveError, SaveErrorKind};
use exocarp::vdb::VdbError;
use exocarp::verify::VerifyError;
use exocarp::{Cancelled, Error, InputError, OffsetError, ThickenError, ThickenSettingsError, ThreadError};
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
            log_interrupted();
        } else {
            log_line("error", &self.sentence);
        }
        self.exit.into()
    }
}

/// One line on stderr.
pub(super) fn log_line(kind: &str, sentence: &str) {
    use std::io::Write;
    // Nobody is left to be told when stderr is closed.
    let _ = writeln!(std::io::stderr(), "exocarp: {kind}: {}", sentence.replace('\n', " "));
}

/// Says that the run was interrupted, once: the interrupted command and the signal handler may both
/// get here.
pub(super) fn log_interrupted() {
    static SAID: AtomicBool = AtomicBool::new(false);
    if !SAID.swap(true, Ordering::SeqCst) {
        log_line("error", "interrupted; no file was written");
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Failure::new(of(&error), error.to_string() + remedy(&error))
    }
}

/// Errors of the library that the umbrella takes.
macro_rules! failure_from {
    ($($error:ty),+) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Error::from(error).into()
            }
        }
    )+};
}

failure_from!(Cancelled, LoadError, MergeError, OffsetError, SaveError, ThickenError, ThreadError);
failure_from!(VdbError, VerifyError);

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Self {
        let sentence = error.to_string();
        match error {
            CompareError::Cancelled => Cancelled.into(),
            CompareError::Load(error) => error.into(),
            CompareError::Save(error) => error.into(),
            CompareError::Offset(error) => error.into(),
            CompareError::Verify(error) => error.into(),
            CompareError::Vdb(error) => error.into(),
            CompareError::Setting(_) => Failure::usage(sentence),
            CompareError::Temporary(error) => Failure::new(of_io(&error), sentence),
            _ => Failure::new(Exit::Internal, sentence),
        }
    }
}

impl From<PaperError> for Failure {
    fn from(error: PaperError) -> Self {
        match error {
            PaperError::Cancelled => Cancelled.into(),
            PaperError::Load(error) => error.into(),
            PaperError::Offset(error) => error.into(),
            PaperError::Verify(error) => error.into(),
            _ => Failure::new(Exit::Internal, error.to_string()),
        }
    }
}

/// The part of a sentence that names what the command line can do: the library knows no options.
fn remedy(error: &Error) -> &'static str {
    match error {
        Error::Offset(OffsetError::Input(InputError::Open { .. } | InputError::Misoriented { .. })) => {
            ", or go ahead all the same with --sign pseudonormal"
        }
        Error::Offset(OffsetError::Memory(_)) | Error::Thicken(ThickenError::Memory(_)) => {
            " (or raise --max-memory)"
        }
        Error::Thicken(ThickenError::Settings(ThickenSettingsError::Thickness(_))) => {
            "; --side outer has the solid on the other side"
        }
        Error::Merge(error) if matches!(error.kind, MergeErrorKind::NotATile) => {
            "; exocarp offset --tile writes them"
        }
        Error::Vdb(VdbError::Write { .. }) => "; check the permissions and the free space",
        _ => "",
    }
}

/// Returns the exit code of an error.
fn of(error: &Error) -> Exit {
    match error {
        Error::Cancelled => Exit::Interrupted,
        Error::Load(_) => Exit::Input,
        Error::Offset(error) => of_offset(error),
        Error::Verify(VerifyError::Setting { .. }) => Exit::Usage,
        Error::Verify(_) => Exit::Input,
        Error::Thicken(error) => of_thicken(error),
        Error::Threads(_) => Exit::Limit,
        Error::Save(error) => match &error.kind {
            SaveErrorKind::Extension(_) => Exit::Usage,
            SaveErrorKind::Create(e) | SaveErrorKind::Write(e) | SaveErrorKind::Replace(e) => of_io(e),
            SaveErrorKind::Coordinate { .. } | SaveErrorKind::TooManyTriangles => Exit::Limit,
            _ => Exit::Internal,
        },
        Error::Merge(error) => match &error.kind {
            MergeErrorKind::Write(e) => of_io(e),
            MergeErrorKind::TooLarge => Exit::Limit,
            MergeErrorKind::Empty => Exit::Empty,
            _ => Exit::Input,
        },
        Error::Vdb(error) => of_vdb(error),
        _ => Exit::Internal,
    }
}

fn of_offset(error: &OffsetError) -> Exit {
    match error {
        OffsetError::Cancelled => Exit::Interrupted,
        OffsetError::Settings(_) => Exit::Usage,
        OffsetError::Input(_) => Exit::Input,
        OffsetError::Empty(_) => Exit::Empty,
        OffsetError::Memory(_) | OffsetError::Lattice(_) => Exit::Limit,
        OffsetError::Vdb(error) => of_vdb(error),
        _ => Exit::Internal,
    }
}

fn of_thicken(error: &ThickenError) -> Exit {
    match error {
        ThickenError::Cancelled => Exit::Interrupted,
        ThickenError::Settings(_) => Exit::Usage,
        ThickenError::Patch(_) => Exit::Input,
        ThickenError::Obstacle { .. } | ThickenError::Memory(_) | ThickenError::Lattice(_) => Exit::Limit,
        ThickenError::Offset(error) => of_offset(error),
        _ => Exit::Internal,
    }
}

fn of_vdb(error: &VdbError) -> Exit {
    match error {
        VdbError::Cancelled => Exit::Interrupted,
        VdbError::Read { .. }
        | VdbError::NotVdb { .. }
        | VdbError::MissingGrid { .. }
        | VdbError::Unsuitable { .. } => Exit::Input,
        VdbError::Size { .. } => Exit::Limit,
        VdbError::Write { reason, .. } if is_full(reason) => Exit::Limit,
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
