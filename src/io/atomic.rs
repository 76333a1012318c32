//! Output files that appear whole or not at all.
//!
//! The content goes to a temporary file beside the target, which is renamed when complete. A
//! failure, a panic or a cancelled run removes the temporary file and leaves an existing target as
//! it was. The file gets the permissions of the one that it replaces, or else those of any new file
//! (the umask decides). A symbolic link keeps pointing to its file, and that file is replaced. Not
//! promised: that the content is on the disk after a loss of power.
//!
//! The program replaces several files together, and takes from here what it needs for that.

use std::fs::File;
use std::io::{BufWriter, Error, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::error::{SaveError, SaveErrorKind};

/// Writes the file `path` through `write`.
pub(crate) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), SaveError> {
    let at = |kind| SaveError { path: path.to_path_buf(), kind };
    let mut replacement = Replacement::create(path).map_err(|e| at(SaveErrorKind::Create(e)))?;
    let mut writer = BufWriter::with_capacity(1 << 16, replacement.temporary.as_file_mut());
    write(&mut writer).and_then(|()| writer.flush()).map_err(|e| at(SaveErrorKind::Write(e)))?;
    drop(writer);
    replacement.commit().map_err(|e| at(SaveErrorKind::Replace(e)))
}

/// A temporary file that replaces another one when it is complete, and is removed when dropped
/// before.
pub(crate) struct Replacement {
    target: PathBuf,
    temporary: NamedTempFile,
}

impl Replacement {
    /// Creates an empty file beside `path`, with the same extension.
    ///
    /// # Errors
    /// When no file can be created there, or `path` is something else than a file: a directory, a
    /// pipe or a device, which a file must not take the place of.
    pub fn create(path: &Path) -> std::io::Result<Self> {
        let target = resolved(path);
        if target.exists() && !target.is_file() {
            let kind = if target.is_dir() { ErrorKind::IsADirectory } else { ErrorKind::InvalidInput };
            return Err(Error::new(kind, "it is not a regular file"));
        }
        let temporary = create_beside(&target)?;
        Ok(Replacement { target, temporary })
    }

    /// Returns the path of the temporary file, which may be overwritten or created anew.
    #[cfg(any(test, feature = "openvdb"))]
    pub fn path(&self) -> &Path {
        self.temporary.path()
    }

    /// Puts the complete file in place.
    ///
    /// # Errors
    /// When it cannot be renamed; an existing target is left as it was.
    pub fn commit(self) -> std::io::Result<()> {
        keep_permissions(self.temporary.path(), &self.target)?;
        self.temporary.persist(&self.target).map(drop).map_err(|e| e.error)
    }
}

/// Gives `new` the permissions of `old`, the file that it is to replace, if there is one: who may
/// read and write it, not as whom it would run.
pub fn keep_permissions(new: &Path, old: &Path) -> std::io::Result<()> {
    #[cfg(unix)]
    if let Ok(old) = std::fs::metadata(old) {
        use std::os::unix::fs::PermissionsExt;
        let mode = old.permissions().mode() & 0o777;
        // Some file systems know no permissions, and refuse to set them.
        if std::fs::metadata(new)?.permissions().mode() & 0o777 != mode {
            std::fs::set_permissions(new, std::fs::Permissions::from_mode(mode))?;
        }
    }
    Ok(())
}

/// Returns the file behind `path` if that is a symbolic link, so that the link stays one, and else
/// `path`.
pub fn resolved(path: &Path) -> PathBuf {
    match path.is_symlink() {
        true => path.canonicalize().unwrap_or_else(|_| path.to_path_buf()),
        false => path.to_path_buf(),
    }
}

/// Returns the directory that holds `target`.
pub fn directory_of(target: &Path) -> &Path {
    target.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new("."))
}

/// Creates a temporary file in the directory of `target`, with the same extension.
fn create_beside(target: &Path) -> std::io::Result<NamedTempFile> {
    let suffix = target.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    let mut builder = tempfile::Builder::new();
    builder.prefix(".exocarp-").suffix(&suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What `File::create` asks for; the system takes the umask off.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory_of(target))
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
    fn a_failing_writer_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.ply");
        fs::write(&path, "old").unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(b"half")?;
            Err(std::io::Error::other("disk full"))
        })
        .unwrap_err();
        assert!(error.to_string().ends_with(
            "a.ply: writing failed (disk full); check the free space, the output was left as it was"
        ));
        let replacement = Replacement::create(&path).unwrap();
        fs::write(replacement.path(), "half").unwrap();
        drop(replacement);
        let panicked = std::panic::catch_unwind(|| write_atomically(&path, |_| panic!("on purpose")));
        assert!(panicked.is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(directory.path()), ["a.ply"]);
    }

    #[test]
    fn a_complete_file_replaces_the_old_one() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.vdb");
        write_atomically(&path, |w| w.write_all(b"first")).unwrap();
        let replacement = Replacement::create(&path).unwrap();
        assert_eq!(replacement.path().extension().unwrap(), "vdb");
        assert_eq!(fs::read_to_string(&path).unwrap(), "first");
        fs::write(replacement.path(), "second").unwrap();
        replacement.commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(names(directory.path()), ["a.vdb"]);
    }

    #[test]
    fn a_missing_directory_is_named() {
        let path = Path::new("/nonexistent/a.ply");
        let error = write_atomically(path, |_| Ok(())).unwrap_err().to_string();
        assert!(error.starts_with("/nonexistent/a.ply: no file can be created there ("), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn devices_and_directories_are_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        for path in [Path::new("/dev/null"), directory.path()] {
            let error = Replacement::create(path).err().unwrap().to_string();
            assert_eq!(error, "it is not a regular file", "{}", path.display());
        }
        assert!(!Path::new("/dev/null").is_file());
        assert_eq!(names(directory.path()), [""; 0]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file_and_links_stay() {
        let directory = tempfile::tempdir().unwrap();
        let (plain, path) = (directory.path().join("plain"), directory.path().join("a.ply"));
        fs::write(&plain, "").unwrap();
        write_atomically(&path, |_| Ok(())).unwrap();
        let permissions = |path| fs::metadata(path).unwrap().permissions();
        assert_eq!(permissions(&path), permissions(&plain));

        // Those of a file that is replaced stay.
        for mode in [0o444, 0o600] {
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
            write_atomically(&path, |_| Ok(())).unwrap();
            assert_eq!(permissions(&path).mode() & 0o777, mode);
            Replacement::create(&path).unwrap().commit().unwrap();
            assert_eq!(permissions(&path).mode() & 0o777, mode);
        }

        let link = directory.path().join("link.ply");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomically(&link, |w| w.write_all(b"through the link")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&path).unwrap(), "through the link");
    }
}
