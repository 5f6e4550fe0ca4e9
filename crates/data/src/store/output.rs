//! An output folder that is being made: one run makes it, and whatever stops that run the folder stays whole.
//!
//! ```text
//! out/
//!   denim/            the result: put in place in one step, when all of it is written
//!   .denim.work/      beside it, while a run makes it; nobody else can enter it
//!     lock            held by that run
//!     new/            what it has written so far
//!     journal         what it has finished, for a run that goes on from there
//! ```
//!
//! What a killed run leaves in the work folder is cleared by the next one that gets the lock; only the journal is kept.
//! What no run leaves there, such as a link, is refused.

use super::folder::{existing_target, parent, sync_folder};
use super::journal::{Journal, Recalled};
use super::lock::lock;
use super::work;
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// A folder that this run makes, and no other meanwhile. Dropped, it leaves nothing behind but a journal.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    /// The path, links followed.
    target: PathBuf,
    work: PathBuf,
    journal: Option<Journal>,
    in_place: bool,
    _lock: File,
    /// Goes last: removes the folders above.
    _above: MadeFolders,
}

impl OutputFolder {
    /// Claims a folder, which need not exist; makes those above it.
    ///
    /// # Errors
    /// Another run has claimed it; the path names something that is not a folder; something is planted in the work folder;
    /// the operating system refuses.
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

    /// The folder, as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where it is made meanwhile.
    pub fn work(&self) -> &Path {
        &self.work
    }

    /// How many records are kept for a later run.
    pub fn kept(&self) -> usize {
        self.journal.as_ref().map_or(0, Journal::len)
    }

    /// True once the new folder stands in the place of the old one.
    pub fn is_in_place(&self) -> bool {
        self.in_place
    }

    /// What a former run with the same key has finished, and opens the journal for more.
    ///
    /// * `key` — all that determines the result
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn recall<T: DeserializeOwned>(&mut self, key: &impl Serialize) -> Result<Recalled<T>> {
        let (journal, recalled) = Journal::open(&self.work.join("journal"), key)?;
        self.journal = Some(journal);
        Ok(recalled)
    }

    /// Keeps one more record, should this run be stopped; nothing before [`OutputFolder::recall`].
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn keep(&mut self, record: &impl Serialize) -> Result<()> {
        self.journal.as_mut().map_or(Ok(()), |journal| journal.append(record))
    }

    /// Builds the whole folder, then puts it in the place of the old one, which is deleted with the journal.
    ///
    /// # Errors
    /// Those of `build`; the operating system refuses. The old folder is as it was then.
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
            // The disk may not hold it: back, so that an error always means the old folder.
            put(&self.target, &new)?;
            return Err(failed(error));
        }
        self.in_place = true;
        Ok(())
    }

    /// Swaps the new folder and the old one, in one step where the system can.
    fn exchange(&self, new: &Path) -> std::io::Result<()> {
        #[cfg(target_os = "linux")]
        {
            use rustix::fs::{CWD, RenameFlags, renameat_with};
            use rustix::io::Errno;
            match renameat_with(CWD, new, CWD, &self.target, RenameFlags::EXCHANGE) {
                // Some network file systems cannot.
                Err(Errno::INVAL | Errno::NOSYS | Errno::NOTSUP) => {}
                done => return Ok(done?),
            }
        }
        let aside = self.work.join("old");
        fs::rename(&self.target, &aside)?;
        if let Err(error) = fs::rename(new, &self.target) {
            fs::rename(&aside, &self.target)?;
            return Err(error);
        }
        fs::rename(&aside, new)
    }

    /// Clears what a killed run has left, but for its journal.
    fn clear_former(&self) -> Result<()> {
        let [new, old] = ["new", "old"].map(|name| self.work.join(name));
        if old.is_dir() && !self.target.exists() {
            // It was killed in the middle of a swap that takes two steps.
            fs::rename(&old, &self.target).map_err(|source| Error::io(&self.target, source))?;
        }
        for folder in [new, old].iter().filter(|folder| folder.exists()) {
            // Links within it are removed, never what they lead to.
            fs::remove_dir_all(folder).map_err(|source| Error::io(folder, source))?;
        }
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // What cannot be removed now is cleared by the next run.
        let _ = self.clear_former();
        // A journal that was not opened is of a run of another kind.
        if self.in_place || self.journal.as_ref().is_some_and(|journal| journal.len() == 0) {
            let _ = fs::remove_file(self.work.join("journal"));
        }
        // The lock is still held, and given back when its file is closed.
        let _ = fs::remove_file(self.work.join("lock"));
        let _ = fs::remove_dir(&self.work);
    }
}

/// Folders that did not exist before, the innermost first; those that stay empty are removed again.
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
        // Somebody's own file stays.
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
