//! Lock on a work folder. The system releases it when the run ends for any reason.

use super::platform::is_at;
use super::work;
use crate::error::{Error, Result};
use std::fs::{File, TryLockError};
use std::io::ErrorKind;
use std::path::Path;

/// Enters and locks the work folder for the output folder of a path.
///
/// # Errors
/// A lock held by another run; something else in place of the work folder or its lock; a failed system call.
pub(super) fn lock(folder: &Path, path: &Path) -> Result<File> {
    let at = folder.join("lock");
    // A run that ends removes lock and folder: retry. This cannot happen a hundred times in a row.
    for _ in 0..100 {
        work::enter(folder)?;
        let file = match work::open(&at) {
            Err(Error::Io { source, .. })
                if matches!(source.kind(), ErrorKind::NotFound | ErrorKind::AlreadyExists) =>
            {
                continue;
            }
            opened => opened?,
        };
        match file.try_lock() {
            // The previous holder of the lock may have removed it.
            Ok(()) if is_at(&file, &at) => return Ok(file),
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => break,
            Err(TryLockError::Error(source)) => return Err(Error::io(&at, source)),
        }
    }
    let expected = "one run at a time: wait until it has ended, or write to another folder";
    Err(Error::input(path, None, "folder", "another run that writes there", expected))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_lock_whose_file_was_removed_is_no_lock() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path().join("lock");
        let file = File::create(&at).unwrap();
        assert!(is_at(&file, &at));
        fs::remove_file(&at).unwrap();
        assert!(!is_at(&file, &at));
        File::create(&at).unwrap();
        assert!(!is_at(&file, &at));
    }
}
