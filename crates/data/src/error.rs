//! Errors of measurements and settings. A fit that does not converge is not an error: see the report.

use crate::notice::Notice;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Invalid input, misuse, or a failed file operation.
#[derive(Debug, Error)]
pub enum Error {
    /// A file with invalid content. Displayed as `file:line field: found …, expected …`.
    #[error("{}{} {field}: found {found}, expected {expected}", on_one_line(path), line.map(|line| format!(":{line}")).unwrap_or_default())]
    Input {
        /// The file or folder.
        path: PathBuf,
        /// Line, from 1, for files that have lines.
        line: Option<usize>,
        /// Column, key or quantity.
        field: String,
        /// The value found.
        found: String,
        /// The value expected, with a remedy.
        expected: String,
    },
    /// The operating system reported an error.
    #[error("{}: {source}", on_one_line(path))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The simulation rejected the problem.
    #[error("{context}: {source}")]
    Mechanics {
        /// The sequence or stage.
        context: String,
        /// The cause.
        source: cloth_sim::error::Error,
    },
    /// A measurement without a matching simulation grid or clip.
    #[error("sequence {sequence}: found {found}, expected {expected}")]
    Geometry {
        /// Name of the sequence.
        sequence: String,
        /// The value found.
        found: String,
        /// The value expected, with a remedy.
        expected: String,
    },
    /// A measurement that contradicts itself.
    #[error("{0}")]
    Contradiction(Box<Notice>),
    /// A setting outside its range.
    #[error("{field}: found {found}, expected {expected}")]
    Setting {
        /// The setting.
        field: &'static str,
        /// The value given.
        found: String,
        /// The values allowed.
        expected: String,
    },
}

/// Result with the crate's [`Error`](enum@Error).
pub type Result<T> = std::result::Result<T, Error>;

/// Formats a path on one line: a file name may contain a line feed.
fn on_one_line(path: &Path) -> String {
    let escaped = |c: char| if c.is_control() { c.escape_default().collect() } else { String::from(c) };
    path.display().to_string().chars().map(escaped).collect()
}

impl Error {
    /// Invalid input in `path`.
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

    /// A sequence without a matching grid or clip.
    pub fn geometry(sequence: &str, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Geometry { sequence: sequence.into(), found: found.into(), expected: expected.into() }
    }

    /// A failed system call on `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), source }
    }
}
