//! Output files and folders that stay consistent when the program is interrupted.
//!
//! Every writer holds one lock, and the interrupt handler takes it before it exits: a write in progress is finished,
//! and no other is started.

use crate::failure::with_option;
use cloth_data::error::Error;
use cloth_data::store::{OutputFolder, Recalled, write_file};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Output folders in progress.
static MAKING: Mutex<Vec<OutputFolder>> = Mutex::new(Vec::new());

fn making() -> MutexGuard<'static, Vec<OutputFolder>> {
    // The folders can be tidied up even if a writer panicked.
    MAKING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs a write that must not be interrupted and is not an [`Output`].
pub(crate) fn whole<T>(write: impl FnOnce() -> T) -> T {
    let _held = making();
    write()
}

/// Writes text to a file, which must not be the input it was made from.
///
/// # Errors
/// `out` is `input`; I/O errors.
pub(crate) fn write(flag: &str, out: &Path, input: &Path, text: &str) -> Result<(), Error> {
    if let (Ok(out), Ok(same)) = (out.canonicalize(), input.canonicalize())
        && out == same
    {
        let expected = "another file: the input is never changed";
        return Err(Error::input(input, None, flag, "the input itself", expected));
    }
    whole(|| write_file(out, text.as_bytes()))
}

/// The output folder of a command, claimed from the start of the computation until the result is in place.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
}

impl Output {
    /// Claims a folder.
    ///
    /// # Errors
    /// As [`OutputFolder::claim`].
    pub fn claim(path: &Path) -> Result<Self, Error> {
        let mut making = making();
        making.push(OutputFolder::claim(path).map_err(|error| with_option(error, "--out"))?);
        Ok(Self { path: path.to_path_buf() })
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the records of an earlier run with the same key; from then on [`Self::keep`] adds records.
    ///
    /// # Errors
    /// I/O errors.
    pub fn recall<T: DeserializeOwned>(&self, key: &impl Serialize) -> Result<Recalled<T>, Error> {
        self.with(|folder| folder.recall(key))
    }

    /// Records a finished part, so that a stopped run can resume after it.
    ///
    /// # Errors
    /// I/O errors.
    pub fn keep(&self, record: &impl Serialize) -> Result<(), Error> {
        self.with(|folder| folder.keep(record))
    }

    /// Builds the folder and replaces the old one with it.
    ///
    /// # Errors
    /// Errors of `build`; I/O errors.
    pub fn replace(&self, build: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
        self.with(|folder| folder.replace(build))
    }

    fn with<T>(&self, action: impl FnOnce(&mut OutputFolder) -> T) -> T {
        let mut making = making();
        let folder = making.iter_mut().find(|folder| folder.path() == self.path);
        action(folder.expect("the folder is listed until this is dropped"))
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        making().retain(|folder| folder.path() != self.path);
    }
}

/// Waits for the write in progress, tidies up every folder, prints what is left, and exits while holding the lock, so
/// that nothing else is written.
#[cfg(unix)]
pub(crate) fn end(code: i32) -> ! {
    use std::io::Write;
    let mut making = making();
    let left: Vec<String> = making.iter().map(left).collect();
    making.clear();
    crate::progress::clear();
    let left = if left.is_empty() { String::new() } else { format!(": {}", left.join("; ")) };
    // Standard error may be closed.
    let _ = writeln!(std::io::stderr(), "interrupted{left}");
    std::process::exit(code)
}

/// Describes what is left of an output folder in progress.
#[cfg(unix)]
fn left(folder: &OutputFolder) -> String {
    let path = folder.path().display();
    match folder.kept() {
        _ if folder.is_in_place() => format!("the result is in {path}"),
        0 => format!("{path} is unchanged"),
        kept => format!(
            "{path} is unchanged; the same command resumes after {kept} finished {}, kept in {}",
            if kept == 1 { "part" } else { "parts" },
            folder.work().display()
        ),
    }
}
