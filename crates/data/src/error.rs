//! What can be wrong with measurements and settings. A fit that does not converge is no error: see the report.

use crate::notice::Notice;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Bad input, misuse, or a file that could not be read or written.
#[derive(Debug, Error)]
pub enum Error {
    /// A file does not say what it should. Shown as `file:line field: found …, expected …`.
    #[error("{}{} {field}: found {found}, expected {expected}", on_one_line(path), line.map(|line| format!(":{line}")).unwrap_or_default())]
    Input {
        /// The file or folder.
        path: PathBuf,
        /// Line, from 1, where the file has lines.
        line: Option<usize>,
        /// Column, key or quantity.
        field: String,
        /// What stands there.
        found: String,
        /// What should, and what to do.
        expected: String,
    },
    /// The operating system refused.
    #[error("{}: {source}", on_one_line(path))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The mechanics refused the problem.
    #[error("{context}: {source}")]
    Mechanics {
        /// Which sequence or stage.
        context: String,
        /// Why.
        source: cloth_sim::error::Error,
    },
    /// A measurement that no simulation grid or clip fits.
    #[error("sequence {sequence}: found {found}, expected {expected}")]
    Geometry {
        /// Name of the sequence.
        sequence: String,
        /// What was found.
        found: String,
        /// What was expected, and what to do.
        expected: String,
    },
    /// A measurement that contradicts itself.
    #[error("{0}")]
    Contradiction(Notice),
    /// A setting is outside what it may be.
    #[error("{field}: found {found}, expected {expected}")]
    Setting {
        /// The setting.
        field: &'static str,
        /// What was given.
        found: String,
        /// What it may be.
        expected: String,
    },
}

/// Result with the crate's [`Error`](enum@Error).
pub type Result<T> = std::result::Result<T, Error>;

/// A path as a message shows it: a name may hold a line feed.
fn on_one_line(path: &Path) -> String {
    let escaped = |c: char| if c.is_control() { c.escape_default().collect() } else { String::from(c) };
    path.display().to_string().chars().map(escaped).collect()
}

impl Error {
    /// Bad input in `path`.
    pub fn input(
        path: &Path,
        line: impl Into<Option<usize>>,
        field: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Input {
            path: path.to_path_buf(),
            line: line.into(),
            field: field.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// A sequence that no grid or clip fits.
    pub fn geometry(sequence: &str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Geometry { sequence: sequence.into(), found: found.into(), expected: expected.into() }
    }

    /// A failed call to the operating system on `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), source }
    }
}
