//! Output files that appear whole or not at all.
//!
//! The content goes to a temporary file beside the target, which is renamed when complete. A failure, a panic
//! or a cancelled run removes the temporary file and leaves an existing target as it was. The file gets the
//! permissions of the one that it replaces, or else those of any new file (the umask decides). A symbolic
//! link keeps pointing to its file, and that file is replaced. Not promised: that the content is on the disk
//! after a loss of power.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::error::{SaveError, SaveErrorKind};

/// Writes the file `path` through `write`.
pub(crate) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> std::io::Result<()>,
) -> Result<(), SaveError> {
    let at = |kind| SaveError { path: path.to_path_buf(), kind };
    let target = target(path);
    let mut temporary = create_beside(&target).map_err(|e| at(SaveErrorKind::Create(e)))?;
    let mut writer = BufWriter::with_capacity(1 << 16, temporary.as_file_mut());
    write(&mut writer).and_then(|()| writer.flush()).map_err(|e| at(SaveErrorKind::Write(e)))?;
    drop(writer);
    keep_permissions(temporary.path(), &target).map_err(|e| at(SaveErrorKind::Replace(e)))?;
    temporary.persist(&target).map_err(|e| at(SaveErrorKind::Replace(e.error)))?;
    Ok(())
}

/// Writes the file `path` through `write`, which gets the path of the temporary file: it has the same
/// extension, exists, is empty, and may be overwritten or created anew.
#[allow(dead_code, reason = "the writer of .vdb files, which works by path, is its user")]
pub(crate) fn write_path_atomically<E: From<SaveError>>(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    let at = |kind| SaveError { path: path.to_path_buf(), kind };
    let target = target(path);
    let temporary = create_beside(&target).map_err(|e| at(SaveErrorKind::Create(e)))?.into_temp_path();
    write(&temporary)?;
    keep_permissions(&temporary, &target).map_err(|e| at(SaveErrorKind::Replace(e)))?;
    temporary.persist(&target).map_err(|e| at(SaveErrorKind::Replace(e.error)))?;
    Ok(())
}

/// Gives `new` the permissions of `old`, the file that it is to replace, if there is one: who may read and
/// write it, not as whom it would run. For the program, too, which replaces several files together.
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

/// The file that `path` stands for: the one behind it if it is a symbolic link.
fn target(path: &Path) -> PathBuf {
    match path.is_symlink() {
        true => path.canonicalize().unwrap_or_else(|_| path.to_path_buf()),
        false => path.to_path_buf(),
    }
}

/// Creates a temporary file in the directory of `target`, with the same extension.
fn create_beside(target: &Path) -> std::io::Result<NamedTempFile> {
    let directory = match target.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let suffix = target.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    let mut builder = tempfile::Builder::new();
    builder.prefix(".exocarp-").suffix(&suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What `File::create` asks for; the system takes the umask off.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
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
        let failed: Result<(), SaveError> = write_path_atomically(&path, |temporary| {
            fs::write(temporary, "half").unwrap();
            Err(error)
        });
        assert!(failed.is_err());
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
        write_path_atomically::<SaveError>(&path, |temporary| {
            assert_eq!(temporary.extension().unwrap(), "vdb");
            assert_eq!(fs::read_to_string(&path).unwrap(), "first");
            fs::write(temporary, "second").unwrap();
            Ok(())
        })
        .unwrap();
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
            write_path_atomically::<SaveError>(&path, |_| Ok(())).unwrap();
            assert_eq!(permissions(&path).mode() & 0o777, mode);
        }

        let link = directory.path().join("link.ply");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomically(&link, |w| w.write_all(b"through the link")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read_to_string(&path).unwrap(), "through the link");
    }
}
