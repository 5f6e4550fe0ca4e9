//! Resolves links of paths.

use crate::error::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Target of a path, links followed; `None` if nothing exists there.
pub(super) fn existing_target(path: &Path) -> Result<Option<PathBuf>> {
    match fs::canonicalize(path) {
        Ok(target) => Ok(Some(target)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound && path.is_symlink() => {
            let expected = "one that leads to what is to be replaced, or nothing: remove the link";
            Err(Error::input(path, None, "file", "a link that leads nowhere", expected))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Error::io(path, error)),
    }
}

/// Parent folder of a path.
pub(super) fn parent(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}
