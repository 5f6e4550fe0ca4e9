//! Journal of finished work, record by record, from which a later run can resume.
//!
//! ```text
//! record   length of the content, u64, little endian · SHA-256 of the content · content, MessagePack
//! journal  the key's digest · records
//! ```
//!
//! Numbers are stored exactly. An incomplete record and everything after it are ignored.

use super::work;
use crate::error::{Error, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Finished work of an earlier run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recalled<T> {
    /// Its records, in the order in which they were kept.
    pub records: Vec<T>,
    /// True if a journal with another key was here and has been discarded.
    pub forgotten: bool,
}

/// Bytes of length and checksum.
const HEADER: usize = 8 + 32;

/// A journal, open at its end.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    records: usize,
}

impl Journal {
    /// Opens a journal, or starts a new one if there is none or its key differs.
    ///
    /// # Errors
    /// Something other than a journal at the path; a failed system call.
    pub(super) fn open<T: DeserializeOwned>(
        path: &Path,
        key: &impl Serialize,
    ) -> Result<(Self, Recalled<T>)> {
        let failed = |source| Error::io(path, source);
        let mut journal = Self { path: path.to_path_buf(), file: work::open(path)?, records: 0 };
        let mut bytes = Vec::new();
        journal.file.read_to_end(&mut bytes).map_err(failed)?;
        let key = Sha256::digest(journal.encoded(key)?);
        let mut rest = &bytes[..];
        let mut recalled = Recalled { records: Vec::new(), forgotten: false };
        let mut end = 0;
        if next(&mut rest).is_some_and(|found| found == &key[..]) {
            end = bytes.len() - rest.len();
            while let Some(record) = next(&mut rest).and_then(|content| rmp_serde::from_slice(content).ok()) {
                recalled.records.push(record);
                end = bytes.len() - rest.len();
            }
        } else {
            recalled.forgotten = next(&mut rest).is_some();
        }
        journal.file.set_len(end as u64).map_err(failed)?;
        journal.file.seek(SeekFrom::End(0)).map_err(failed)?;
        if end == 0 {
            journal.write(&key)?;
        }
        journal.records = recalled.records.len();
        Ok((journal, recalled))
    }

    /// Number of records, without the key.
    pub(super) fn len(&self) -> usize {
        self.records
    }

    /// Appends a record and returns after it is on disk.
    ///
    /// # Errors
    /// A failed system call.
    pub(super) fn append(&mut self, record: &impl Serialize) -> Result<()> {
        let content = self.encoded(record)?;
        self.write(&content)?;
        self.records += 1;
        Ok(())
    }

    fn encoded(&self, record: &impl Serialize) -> Result<Vec<u8>> {
        // With field names, since some types omit fields.
        rmp_serde::to_vec_named(record).map_err(|error| Error::io(&self.path, std::io::Error::other(error)))
    }

    fn write(&mut self, content: &[u8]) -> Result<()> {
        let mut record = (content.len() as u64).to_le_bytes().to_vec();
        record.extend_from_slice(&Sha256::digest(content));
        record.extend_from_slice(content);
        let written = self.file.write_all(&record).and_then(|()| self.file.sync_all());
        written.map_err(|source| Error::io(&self.path, source))
    }
}

/// Takes the next complete record from the front.
fn next<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (header, rest) = bytes.split_at_checked(HEADER)?;
    let (length, checksum) = header.split_at(8);
    let length = usize::try_from(u64::from_le_bytes(length.try_into().ok()?)).ok()?;
    let (content, rest) = rest.split_at_checked(length)?;
    (checksum == &Sha256::digest(content)[..]).then(|| {
        *bytes = rest;
        content
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torn_or_altered_record_and_what_follows_do_not_count() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal");
        let open = || Journal::open::<String>(&path, &"key").unwrap();
        let (mut journal, _) = open();
        ["first", "second"].iter().for_each(|record| journal.append(record).unwrap());
        let whole = std::fs::read(&path).unwrap();
        let ends: Vec<usize> = {
            let mut rest = &whole[..];
            std::iter::from_fn(|| next(&mut rest).map(|_| whole.len() - rest.len())).collect()
        };
        assert_eq!(ends.len(), 3);
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).unwrap();
            let (mut journal, recalled) = open();
            let expected = ends[1..].iter().filter(|end| **end <= cut).count();
            assert_eq!(recalled.records, ["first", "second"][..expected], "cut at {cut}");
            // A record added afterwards is complete.
            journal.append(&"next").unwrap();
            assert_eq!(open().1.records.len(), expected + 1, "cut at {cut}");
        }
        for place in 0..whole.len() {
            let mut altered = whole.clone();
            altered[place] ^= 1;
            std::fs::write(&path, altered).unwrap();
            let expected = ends.iter().take_while(|end| **end <= place).count().saturating_sub(1);
            assert_eq!(open().1.records.len(), expected, "altered at {place}");
        }
    }
}
