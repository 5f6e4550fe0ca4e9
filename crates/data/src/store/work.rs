//! The private work folder beside an output folder. Only contents left by a run are followed, read or removed.
//!
//! Anyone with write access to the parent folder, or the author of an archive that contained it, could have planted a
//! folder of that name with links or pipes in it.

use super::folder::parent;
use super::platform;

use crate::error::{Error, Result};
use std::fs::{self, File, Metadata};
use std::io::ErrorKind;
use std::path::Path;

/// Creates a private work folder, or takes over one left by a stopped run.
///
/// # Errors
/// Something other than a folder, or a folder that others can write; a failed system call.
pub(super) fn enter(work: &Path) -> Result<()> {
    let failed = |source| Error::io(work, source);
    match platform::private_folder().create(work) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
        made => return made.map_err(failed),
    }
    let about = match fs::symlink_metadata(work) {
        // Another run has just ended: opening the lock will show.
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        about => about.map_err(failed)?,
    };
    if !about.is_dir() {
        return Err(planted(work, kind(&about), "a folder"));
    }
    check_owner(work, &about)
}

/// Opens or creates a file of a work folder.
///
/// # Errors
/// Something other than a regular file, or a file with a second hard link; a failed system call.
pub(super) fn open(path: &Path) -> Result<File> {
    let failed = |source| Error::io(path, source);
    let mut options = File::options();
    options.read(true).write(true);
    match fs::symlink_metadata(path) {
        Ok(about) => check_file(path, &about)?,
        Err(error) if error.kind() == ErrorKind::NotFound => drop(options.create_new(true)),
        Err(error) => return Err(failed(error)),
    }
    platform::refuse_links(&mut options);
    let file = options.open(path).map_err(failed)?;
    check_file(path, &file.metadata().map_err(failed)?)?;
    Ok(file)
}

/// Refuses a work folder with contents that no run leaves.
///
/// # Errors
/// A link, a pipe or a device; a file in place of a folder, or the reverse; a failed system call.
pub(super) fn check(work: &Path) -> Result<()> {
    for (name, is_folder) in [("journal", false), ("new", true), ("old", true)] {
        let path = work.join(name);
        match fs::symlink_metadata(&path) {
            Ok(about) if is_folder && about.is_dir() => check_tree(&path)?,
            Ok(about) if is_folder => return Err(planted(&path, kind(&about), "a folder")),
            Ok(about) => check_file(&path, &about)?,
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(Error::io(&path, error)),
        }
    }
    Ok(())
}

/// Refuses a folder that contains anything but folders and regular files.
fn check_tree(folder: &Path) -> Result<()> {
    let failed = |source| Error::io(folder, source);
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let about = fs::symlink_metadata(&path).map_err(|source| Error::io(&path, source))?;
        match about.is_dir() {
            true => check_tree(&path)?,
            false if about.is_file() => {}
            false => return Err(planted(&path, kind(&about), "a file")),
        }
    }
    Ok(())
}

/// Refuses anything but a regular file, and files with a second hard link, through which another file would be
/// overwritten.
fn check_file(path: &Path, about: &Metadata) -> Result<()> {
    if !about.is_file() {
        return Err(planted(path, kind(about), "a file"));
    }
    if platform::has_other_names(about) {
        return Err(planted(path, "a file with a second name elsewhere", "a file with one"));
    }
    Ok(())
}

/// Refuses a folder owned by another user, or writable by others.
fn check_owner(work: &Path, about: &Metadata) -> Result<()> {
    match platform::foreign(about, &parent(work)).map_err(|source| Error::io(work, source))? {
        Some(found) => Err(planted(work, found, "a folder that only you can write")),
        None => Ok(()),
    }
}

fn kind(about: &Metadata) -> &'static str {
    match about {
        _ if about.is_symlink() => "a link",
        _ if about.is_dir() => "a folder",
        _ if about.is_file() => "a file",
        _ => "a pipe, socket or device",
    }
}

fn planted(path: &Path, found: &str, expected: &str) -> Error {
    let expected = format!("{expected}, left by a stopped run: remove it, or write to another place");
    Error::input(path, None, "work folder", found, expected)
}
