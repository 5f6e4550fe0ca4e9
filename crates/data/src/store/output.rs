//! An output folder under construction: one run writes it, and an interruption leaves the existing folder intact.
//!
//! ```text
//! out/
//!   denim/            the result: put in place in one step, once complete
//!   .denim.work/      private work folder of the run
//!     lock            held by the run
//!     new/            output so far
//!     journal         finished work, for a run that resumes
//! ```
//!
//! Remains of a killed run are cleared by the next run that gets the lock; only the journal is kept. Contents that no
//! run leaves there, such as links, are refused.

use super::folder::{existing_target, parent};
use super::journal::{Journal, Recalled};
use super::lock::lock;
use super::platform::sync_folder;
use super::{platform, work};
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// An output folder claimed by this run exclusively. Dropped, it leaves at most a journal behind.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// Path of the folder, links followed.
    target: PathBuf,
    work: PathBuf,
    journal: Option<Journal>,
    in_place: bool,
    _lock: File,
    /// Dropped last: removes empty parent folders.
    _above: MadeFolders,
}

impl OutputFolder {
    /// Claims a folder, which need not exist; creates its parents.
    ///
    /// # Errors
    /// A folder claimed by another run; a path to something other than a folder; foreign contents in the work folder;
    /// a failed system call.
    pub fn claim(path: &Path) -> Result<Self> {
        let old = existing_target(path)?;
        let target = old.clone().unwrap_or_else(|| path.to_path_buf());
        let Some(name) = target.file_name().filter(|_| old.is_none_or(|old| old.is_dir())) else {
            let expected = "a folder with a name to replace, or nothing";
            return Err(Error::input(path, None, "folder", "something else", expected));
        };
        let hidden: OsString = [".".as_ref(), name, ".work".as_ref()].into_iter().collect();
        let folder = parent(&target).join(hidden);
        let above = MadeFolders::make(&parent(&target))?;
        let lock = lock(&folder, path)?;
        work::check(&folder)?;
        let claimed = Self {
            path: path.to_path_buf(),
            target,
            work: folder,
            journal: None,
            in_place: false,
            _lock: lock,
            _above: above,
        };
        claimed.clear_former()?;
        Ok(claimed)
    }

    /// Path of the folder, as given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The work folder.
    pub fn work(&self) -> &Path {
        &self.work
    }

    /// Number of records kept for a later run.
    pub fn kept(&self) -> usize {
        self.journal.as_ref().map_or(0, Journal::len)
    }

    /// True once the new folder has replaced the old one.
    pub fn is_in_place(&self) -> bool {
        self.in_place
    }

    /// Returns the records of an earlier run with the same key, and opens the journal for more.
    ///
    /// * `key` — everything that determines the result
    ///
    /// # Errors
    /// A failed system call.
    pub fn recall<T: DeserializeOwned>(&mut self, key: &impl Serialize) -> Result<Recalled<T>> {
        let (journal, recalled) = Journal::open(&self.work.join("journal"), key)?;
        self.journal = Some(journal);
        Ok(recalled)
    }

    /// Keeps one more record for a run that resumes; does nothing before [`OutputFolder::recall`].
    ///
    /// # Errors
    /// A failed system call.
    pub fn keep(&mut self, record: &impl Serialize) -> Result<()> {
        self.journal.as_mut().map_or(Ok(()), |journal| journal.append(record))
    }

    /// Builds the whole folder, then replaces the old one, which is deleted together with the journal.
    ///
    /// # Errors
    /// Those of `build`; a failed system call. The old folder is unchanged then.
    pub fn replace(&mut self, build: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
        let new = self.work.join("new");
        fs::create_dir(&new).map_err(|source| Error::io(&new, source))?;
        build(&new)?;
        let failed = |source| Error::io(&self.path, source);
        sync_folder(&new).map_err(failed)?;
        let old = existing_target(&self.target)?.is_some();
        let put = |from: &Path, to: &Path| {
            let put = if old { self.exchange(&new) } else { fs::rename(from, to) };
            put.map_err(failed)
        };
        put(&new, &self.target)?;
        if let Err(error) = sync_folder(&parent(&self.target)) {
            // The disk may not hold it: swap back, so that an error always means the old folder.
            put(&self.target, &new)?;
            return Err(failed(error));
        }
        self.in_place = true;
        Ok(())
    }

    /// Swaps the new folder and the old one, atomically where the system supports it.
    fn exchange(&self, new: &Path) -> std::io::Result<()> {
        if platform::exchange(new, &self.target)? {
            return Ok(());
        }
        let aside = self.work.join("old");
        fs::rename(&self.target, &aside)?;
        if let Err(error) = fs::rename(new, &self.target) {
            fs::rename(&aside, &self.target)?;
            return Err(error);
        }
        fs::rename(&aside, new)
    }

    /// Clears the remains of a killed run except its journal.
    fn clear_former(&self) -> Result<()> {
        let [new, old] = ["new", "old"].map(|name| self.work.join(name));
        if old.is_dir() && !self.target.exists() {
            // Killed in the middle of a two-step swap.
            fs::rename(&old, &self.target).map_err(|source| Error::io(&self.target, source))?;
        }
        for folder in [new, old].iter().filter(|folder| folder.exists()) {
            // Links are removed, not their targets.
            fs::remove_dir_all(folder).map_err(|source| Error::io(folder, source))?;
        }
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // Files that cannot be removed now are cleared by the next run.
        let _ = self.clear_former();
        // An unopened journal belongs to another kind of run.
        if self.in_place || self.journal.as_ref().is_some_and(|journal| journal.len() == 0) {
            let _ = fs::remove_file(self.work.join("journal"));
        }
        // The lock is still held; closing its file releases it.
        let _ = fs::remove_file(self.work.join("lock"));
        let _ = fs::remove_dir(&self.work);
    }
}

/// Newly created folders, innermost first; those still empty are removed again.
#[derive(Debug)]
struct MadeFolders(Vec<PathBuf>);

impl MadeFolders {
    fn make(folder: &Path) -> Result<Self> {
        let missing = folder.ancestors().take_while(|above| !above.as_os_str().is_empty() && !above.exists());
        let made = Self(missing.map(Path::to_path_buf).collect());
        if !made.0.is_empty() {
            fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
        }
        Ok(made)
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::write_file;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn one_run_at_a_time_and_nothing_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("above/result");
        let claimed = OutputFolder::claim(&path).unwrap();
        let error = OutputFolder::claim(&path).unwrap_err();
        assert!(matches!(error, Error::Input { .. }), "{error}");
        assert!(error.to_string().contains("another run that writes there"), "{error}");
        drop(claimed);
        assert!(names(folder.path()).is_empty());
        OutputFolder::claim(&path).unwrap().replace(|new| write_file(&new.join("a"), b"1")).unwrap();
        assert_eq!(
            (names(&folder.path().join("above")), names(&path)),
            (vec!["result".into()], vec!["a".into()])
        );
    }

    #[test]
    fn what_a_killed_run_left_is_cleared_and_a_folder_set_aside_comes_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        let work = folder.path().join(".result.work");
        for (left, content) in [("old", "whole"), ("new", "half")] {
            fs::create_dir_all(work.join(left)).unwrap();
            fs::write(work.join(left).join(content), "").unwrap();
        }
        // A file of the user stays.
        fs::write(work.join("mine"), "").unwrap();
        let claimed = OutputFolder::claim(&path).unwrap();
        assert_eq!((names(&path), names(&work)), (vec!["whole".into()], vec!["lock".into(), "mine".into()]));
        drop(claimed);
        assert_eq!(names(&work), ["mine"]);
    }

    #[test]
    fn what_was_kept_comes_back_for_the_same_key_until_the_folder_is_in_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        let records = [vec![f64::NAN, -0.0], vec![f64::INFINITY, 0.1 + 0.2]];
        let recall = |key: &str| {
            let mut claimed = OutputFolder::claim(&path).unwrap();
            let recalled: Recalled<Vec<f64>> = claimed.recall(&key).unwrap();
            (claimed, recalled)
        };
        let (mut claimed, recalled) = recall("a");
        assert!(recalled.records.is_empty() && !recalled.forgotten);
        records.iter().for_each(|record| claimed.keep(record).unwrap());
        drop(claimed);
        // Another run that fails, without a journal of its own.
        drop(OutputFolder::claim(&path).unwrap());
        let (claimed, recalled) = recall("a");
        let bits =
            |records: &[Vec<f64>]| -> Vec<u64> { records.iter().flatten().map(|x| x.to_bits()).collect() };
        assert_eq!(bits(&recalled.records), bits(&records));
        assert_eq!(claimed.kept(), 2);
        drop(claimed);
        let (claimed, recalled) = recall("b");
        assert!(recalled.records.is_empty() && recalled.forgotten);
        drop(claimed);
        assert!(names(folder.path()).is_empty());
        let (mut claimed, _) = recall("a");
        claimed.keep(&records[0]).unwrap();
        claimed.replace(|_| Ok(())).unwrap();
        drop(claimed);
        assert_eq!(names(folder.path()), ["result"]);
    }
}
