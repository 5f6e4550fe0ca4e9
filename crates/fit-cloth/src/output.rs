//! What a command writes, kept whole when the program is interrupted.
//!
//! Whoever writes holds one lock, and an interruption takes it first: so what is being written is finished before the
//! program ends, or was never begun.

use crate::failure::with_option;
use cloth_data::error::Error;
use cloth_data::store::{OutputFolder, Recalled, write_file};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The folders that are being made.
static MAKING: Mutex<Vec<OutputFolder>> = Mutex::new(Vec::new());

fn making() -> MutexGuard<'static, Vec<OutputFolder>> {
    // A writer that panicked has left a folder that can be put in order all the same.
    MAKING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes something that an interruption must not cut in two, and that is no [`Output`].
pub(crate) fn whole<T>(write: impl FnOnce() -> T) -> T {
    let _held = making();
    write()
}

/// Writes text to a file that is not the one it was made from.
///
/// # Errors
/// The same file; what the operating system refuses.
pub(crate) fn write(flag: &str, out: &Path, input: &Path, text: &str) -> Result<(), Error> {
    if let (Ok(out), Ok(same)) = (out.canonicalize(), input.canonicalize())
        && out == same
    {
        let expected = "another file: the input is never changed";
        return Err(Error::input(input, None, flag, "the input itself", expected));
    }
    whole(|| write_file(out, text.as_bytes()))
}

/// The output folder of a command: its own from the start of the computation until the result is in place.
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

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What a former run with the same key has finished; from now on records can be kept.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn recall<T: DeserializeOwned>(&self, key: &impl Serialize) -> Result<Recalled<T>, Error> {
        self.with(|folder| folder.recall(key))
    }

    /// Keeps what is finished, should the program be stopped.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn keep(&self, record: &impl Serialize) -> Result<(), Error> {
        self.with(|folder| folder.keep(record))
    }

    /// Builds the folder and puts it in the place of the old one.
    ///
    /// # Errors
    /// Those of `build`; what the operating system refuses.
    pub fn replace(&self, build: impl FnOnce(&Path) -> Result<(), Error>) -> Result<(), Error> {
        self.with(|folder| folder.replace(build))
    }

    fn with<T>(&self, action: impl FnOnce(&mut OutputFolder) -> T) -> T {
        let mut making = making();
        let folder = making.iter_mut().find(|folder| folder.path() == self.path);
        action(folder.expect("it is there until this is dropped"))
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        making().retain(|folder| folder.path() != self.path);
    }
}

/// Waits until nothing is being written, puts every folder in order, says what is left, and lets nobody write again
/// before the program has ended.
#[cfg(unix)]
pub(crate) fn end(code: i32) -> ! {
    use std::io::Write;
    let mut making = making();
    let left: Vec<String> = making.iter().map(left).collect();
    making.clear();
    crate::progress::clear();
    let left = if left.is_empty() { String::new() } else { format!(": {}", left.join("; ")) };
    // Nobody may be there to read it.
    let _ = writeln!(std::io::stderr(), "interrupted{left}");
    std::process::exit(code)
}

/// What is left of a folder that is being made.
#[cfg(unix)]
fn left(folder: &OutputFolder) -> String {
    let path = folder.path().display();
    match folder.kept() {
        _ if folder.is_in_place() => format!("the result is in {path}"),
        0 => format!("{path} is as it was"),
        kept => format!(
            "{path} is as it was; the same command goes on after {kept} finished {}, kept in {}",
            if kept == 1 { "part" } else { "parts" },
            folder.work().display()
        ),
    }
}
