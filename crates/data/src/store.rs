//! Atomic output: content is written to a temporary neighbour, then renamed into place.
//!
//! After any interruption the path holds either the old or the new content. A killed program may leave a hidden
//! temporary neighbour behind; that of a folder is cleared by the next run that writes it.

mod folder;
mod journal;
mod lock;
mod output;
mod platform;
mod work;

pub use journal::Recalled;
pub use output::OutputFolder;

use crate::error::{Error, Result};
use folder::{existing_target, parent};
use platform::sync_folder;
use std::io::Write;
use std::path::Path;

/// Writes a whole file and replaces an existing one. A link is followed: its target is replaced.
///
/// # Errors
/// A path to something other than a regular file; a failed system call.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<()> {
    let target = existing_target(path)?;
    if target.as_ref().is_some_and(|target| !target.is_file()) {
        return Err(Error::input(
            path,
            None,
            "file",
            "something else",
            "a regular file to replace, or nothing",
        ));
    }
    let target = target.unwrap_or_else(|| path.to_path_buf());
    let folder = parent(&target);
    let failed = |source| Error::io(path, source);
    let mut temporary = temporary().tempfile_in(&folder).map_err(failed)?;
    temporary.write_all(contents).map_err(failed)?;
    temporary.as_file().sync_all().map_err(failed)?;
    temporary.persist(&target).map_err(|error| Error::io(path, error.error))?;
    sync_folder(&folder).map_err(failed)
}

/// Builds a folder beside the existing one, then puts it in its place. Creates missing parent folders.
///
/// If `build` fails, its output is removed and the existing folder stays unchanged.
///
/// # Errors
/// Those of `build` and of [`OutputFolder::claim`]; a failed system call.
pub fn replace_folder(path: &Path, build: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    OutputFolder::claim(path)?.replace(build)
}

/// Refuses a link as the target of a file in a results folder: only the path given by the user is followed.
///
/// # Errors
/// A link.
pub fn refuse_link(path: &Path) -> Result<()> {
    if path.is_symlink() {
        return Err(Error::input(path, None, "file", "a link", "a regular file to replace, or nothing"));
    }
    Ok(())
}

/// A hidden file with default permissions, as left by the user's mask.
fn temporary() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(".tmp");
    platform::user_file(&mut builder);
    builder
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_created_and_replaced_and_nothing_else_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        for contents in ["old", "new"] {
            write_file(&path, contents.as_bytes()).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), contents);
        }
        assert_eq!(names(folder.path()), ["curve.csv"]);
        let inside = folder.path().join("absent").join("curve.csv");
        assert!(matches!(write_file(&inside, b""), Err(Error::Io { .. })));
        assert!(matches!(write_file(folder.path(), b""), Err(Error::Input { .. })));
    }

    #[test]
    fn a_folder_is_created_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sets/set");
        for name in ["old", "new"] {
            replace_folder(&path, |temporary| write_file(&temporary.join(name), b"1")).unwrap();
            assert_eq!(names(&path), [name]);
        }
        assert_eq!(names(&folder.path().join("sets")), ["set"]);
    }

    #[test]
    fn a_failed_build_leaves_the_old_folder() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("set");
        replace_folder(&path, |temporary| write_file(&temporary.join("old"), b"1")).unwrap();
        let failed = replace_folder(&path, |temporary| {
            write_file(&temporary.join("new"), b"1")?;
            Err(Error::input(temporary, None, "anything", "this", "that"))
        });
        assert!(failed.is_err());
        assert_eq!((names(folder.path()), names(&path)), (vec!["set".into()], vec!["old".into()]));
        let file = path.join("old");
        assert!(matches!(replace_folder(&file, |_| Ok(())), Err(Error::Input { .. })));
    }
}
