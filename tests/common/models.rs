//! The public test models, which are not in the repository.

use std::path::PathBuf;

/// Returns the path of a model in the directory `EXOCARP_MODELS`.
pub fn path(name: &str) -> PathBuf {
    let directory = std::env::var_os("EXOCARP_MODELS").expect("EXOCARP_MODELS names a directory");
    let path = PathBuf::from(directory).join(name);
    assert!(path.is_file(), "no file {}", path.display());
    path
}
