//! Contents of a folder.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Names of entries, and whether each is a folder. Hidden files are omitted.
pub(super) type Entries = BTreeMap<String, bool>;

/// Lists a folder.
pub(super) fn entries(folder: &Path) -> Result<Entries> {
    let failed = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::NotFound => Error::input(folder, None, "folder", "nothing", "a folder"),
        std::io::ErrorKind::NotADirectory => Error::input(folder, None, "folder", "a file", "a folder"),
        std::io::ErrorKind::PermissionDenied => {
            Error::input(folder, None, "folder", "no permission to read it", "a readable folder")
        }
        _ => Error::io(folder, error),
    };
    let mut entries = Entries::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let Ok(name) = entry.file_name().into_string() else {
            return Err(Error::input(
                &entry.path(),
                None,
                "name",
                "bytes that are not UTF-8",
                "a name in UTF-8",
            ));
        };
        if !name.starts_with('.') {
            entries.insert(name, entry.path().is_dir());
        }
    }
    Ok(entries)
}
