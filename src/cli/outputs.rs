//! Output files that appear together and whole, or not at all.
//!
//! While they are written they lie in a hidden directory beside their targets, under their own
//! names; only when all of them are complete they are renamed into place. So a run that fails or is
//! interrupted leaves what was there before, and never a mesh without the statistics that belong to
//! it. A file that is replaced hands on its permissions, also where it may only be read: that a
//! directory may be written to is what counts.

use super::exit::{Exit, Failure, of_io};
use exocarp::CancelToken;
use exocarp::internals::io::{directory_of, keep_permissions, resolved};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tempfile::TempDir;

/// The outputs of a run that are not yet in place. Clones share them.
#[derive(Clone)]
pub(super) struct Staging {
    cancel: CancelToken,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    /// Hidden directories beside the targets.
    directories: Vec<TempDir>,
    /// The staged path and the target of each file.
    files: Vec<(PathBuf, PathBuf)>,
}

impl Staging {
    /// Nothing staged yet; nothing will be put in place once `cancel` is cancelled.
    pub fn new(cancel: CancelToken) -> Self {
        Staging { cancel, state: Arc::default() }
    }

    /// The temporary path to write the file for `target` to, which must have passed [`check`].
    pub fn stage(&self, target: &Path) -> Result<PathBuf, Failure> {
        let target = resolved(target);
        let cannot = |e| cannot_write(&target, &e, of_io(&e));
        let directory = staging_directory(directory_of(&target)).map_err(cannot)?;
        let path = directory.path().join(target.file_name().unwrap_or_default());
        let mut state = self.lock();
        state.directories.push(directory);
        state.files.push((path.clone(), target));
        Ok(path)
    }

    /// Puts all staged files in place.
    pub fn commit(&self) -> Result<(), Failure> {
        // Held to the end: the interrupt handler waits for it before it ends the program.
        let mut state = self.lock();
        self.cancel.check()?;
        for (from, to) in std::mem::take(&mut state.files) {
            let replaced = keep_permissions(&from, &to).and_then(|()| std::fs::rename(&from, &to));
            replaced.map_err(|e| cannot_write(&to, &e, of_io(&e)))?;
        }
        state.directories.clear();
        Ok(())
    }

    /// Removes all staged files.
    pub fn discard(&self) {
        // A writer that is still at work may create its file again meanwhile; then once more.
        const TRIES: usize = 5;
        let mut state = self.lock();
        state.files.clear();
        for directory in state.directories.drain(..).map(TempDir::keep) {
            for _ in 0..TRIES {
                if std::fs::remove_dir_all(&directory).is_ok() || !directory.exists() {
                    break;
                }
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Checks, before anything is computed, that all `targets` can be written and differ from one
/// another.
pub(super) fn check<'a>(targets: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    let mut seen: Vec<PathBuf> = Vec::new();
    for path in targets {
        let shown = path.display();
        if path == Path::new("-") {
            return Err(Failure::usage("standard output takes no files; name one (./- if - is its name)"));
        }
        // Paths lose a slash at their end in all that follows.
        if names_a_directory(path) {
            return Err(Failure::usage(format!(
                "{shown} is the name of a directory; leave out what follows it"
            )));
        }
        let target = resolved(path);
        if target.file_name().is_none() || target.is_dir() {
            return Err(Failure::usage(format!("{shown} is a directory; name a file in it")));
        }
        if target.exists() && !target.is_file() {
            return Err(Failure::usage(format!("{shown} is not a regular file; name another output")));
        }
        let directory = directory_of(&target);
        if !directory.is_dir() {
            let missing = directory.display();
            return Err(Failure::usage(format!("{shown}: there is no directory {missing}; create it first")));
        }
        try_file(directory, &target).map_err(|e| {
            let exit = if of_io(&e) == Exit::Limit { Exit::Limit } else { Exit::Usage };
            cannot_write(path, &e, exit)
        })?;
        let whole = directory
            .canonicalize()
            .unwrap_or_else(|_| directory.into())
            .join(target.file_name().unwrap_or_default());
        if seen.contains(&whole) {
            return Err(Failure::usage(format!(
                "two outputs are to be written to {shown}; name different files"
            )));
        }
        seen.push(whole);
    }
    Ok(())
}

/// Only trying tells whether a file of that name can be created there; it is gone again at once.
fn try_file(directory: &Path, target: &Path) -> std::io::Result<()> {
    let name = target.file_name().unwrap_or_default();
    // The name alone may be too long for the directory, and the whole path for the system.
    if let Err(error) = std::fs::symlink_metadata(target)
        && error.kind() != std::io::ErrorKind::NotFound
    {
        return Err(error);
    }
    let staged = staging_directory(directory)?;
    std::fs::File::create_new(staged.path().join(name)).map(drop)
}

/// A new hidden directory beside the targets.
fn staging_directory(directory: &Path) -> std::io::Result<TempDir> {
    tempfile::Builder::new().prefix(".exocarp-").tempdir_in(directory)
}

/// Whether a path says that it is one of a directory: it ends in a slash, or in a dot behind one.
fn names_a_directory(path: &Path) -> bool {
    let bytes = path.as_os_str().as_encoded_bytes();
    let is_separator = |byte: Option<&u8>| byte.is_some_and(|b| std::path::is_separator(char::from(*b)));
    is_separator(bytes.last()) || bytes.strip_suffix(b".").is_some_and(|rest| is_separator(rest.last()))
}

fn cannot_write(path: &Path, error: &std::io::Error, exit: Exit) -> Failure {
    let shown = path.display();
    Failure::new(
        exit,
        format!("{shown} cannot be written ({error}); check the permissions and the free space"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn names(directory: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn files_appear_together_at_the_commit() {
        let dir = tempfile::tempdir().unwrap();
        let staging = Staging::new(CancelToken::default());
        let (a, b) = (dir.path().join("a.ply"), dir.path().join("b.json"));
        fs::write(&a, "old").unwrap();
        fs::write(staging.stage(&a).unwrap(), "new").unwrap();
        fs::write(staging.stage(&b).unwrap(), "{}").unwrap();
        assert_eq!(fs::read_to_string(&a).unwrap(), "old");
        assert!(!b.exists());
        staging.commit().unwrap();
        assert_eq!(fs::read_to_string(&a).unwrap(), "new");
        assert_eq!(names(dir.path()), ["a.ply", "b.json"]);
    }

    #[test]
    fn a_cancelled_run_leaves_what_was_there() {
        let dir = tempfile::tempdir().unwrap();
        let cancel = CancelToken::default();
        let staging = Staging::new(cancel.clone());
        let a = dir.path().join("a.ply");
        fs::write(&a, "old").unwrap();
        fs::write(staging.stage(&a).unwrap(), "new").unwrap();
        cancel.cancel();
        assert_eq!(staging.commit().unwrap_err().exit, Exit::Interrupted);
        staging.discard();
        assert_eq!(names(dir.path()), ["a.ply"]);
        assert_eq!(fs::read_to_string(&a).unwrap(), "old");
    }

    #[test]
    fn targets_are_checked_beforehand() {
        let dir = tempfile::tempdir().unwrap();
        let wrong = |targets: &[&Path]| check(targets.iter().copied()).unwrap_err().exit;
        assert_eq!(wrong(&[dir.path()]), Exit::Usage);
        assert_eq!(wrong(&[&dir.path().join("no/such/a.ply")]), Exit::Usage);
        let (a, again) = (dir.path().join("a.ply"), dir.path().join("./a.ply"));
        assert_eq!(wrong(&[&a, &again]), Exit::Usage);
        check([a.as_path()]).unwrap();
        assert!(names(dir.path()).is_empty());
    }

    #[test]
    fn names_of_directories_are_known() {
        for name in ["o.ply/", "a/o.ply//", "o.ply/.", "./", "/"] {
            assert!(names_a_directory(Path::new(name)), "{name}");
            assert_eq!(check([Path::new(name)]).unwrap_err().exit, Exit::Usage, "{name}");
        }
        for name in ["o.ply", "./o.ply", "o.", "..ply", "a./b"] {
            assert!(!names_a_directory(Path::new(name)), "{name}");
        }
    }

    #[test]
    fn names_that_no_file_can_have_are_found_out_beforehand() {
        let dir = tempfile::tempdir().unwrap();
        let failure = check([dir.path().join("a".repeat(300) + ".ply").as_path()]).unwrap_err();
        assert_eq!(failure.exit, Exit::Usage);
        assert_eq!(check([Path::new("-")]).unwrap_err().exit, Exit::Usage);
        assert!(names(dir.path()).is_empty());
    }

    #[test]
    #[cfg(unix)]
    fn a_file_that_is_replaced_hands_on_its_permissions() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        for mode in [0o444, 0o600, 0o640, 0o666, 0o755] {
            let path = dir.path().join(format!("{mode:o}.ply"));
            fs::write(&path, "old").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            let staging = Staging::new(CancelToken::default());
            check([path.as_path()]).unwrap();
            fs::write(staging.stage(&path).unwrap(), "new").unwrap();
            staging.commit().unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), "new");
            assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o7777, mode);
        }
    }

    #[test]
    #[cfg(unix)]
    fn a_symbolic_link_stays_one() {
        let dir = tempfile::tempdir().unwrap();
        let (file, link) = (dir.path().join("file.ply"), dir.path().join("link.ply"));
        fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        let staging = Staging::new(CancelToken::default());
        fs::write(staging.stage(&link).unwrap(), "new").unwrap();
        staging.commit().unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "new");
    }
}
