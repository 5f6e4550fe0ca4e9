//! Errors that stop a command: message and exit code.

use cloth_data::error::Error;
use std::error::Error as _;
use std::io;

/// An error that stopped a command. A fit that does not converge is not one: see [`Outcome`](crate::outcome::Outcome).
#[derive(Debug)]
pub enum Failure {
    /// A bad measurement, setting or file, or an I/O error.
    Fit(Error),
    /// Standard output could not be written.
    Output(io::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Fit(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl Failure {
    /// 1 for I/O errors, 3 for bad input.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Output(_) | Self::Fit(Error::Io { .. }) => 1,
            Self::Fit(_) => 3,
        }
    }

    /// The error and its chain of causes on one line.
    pub fn in_words(&self) -> String {
        let error = match self {
            Self::Output(error) => return format!("standard output: {error}"),
            Self::Fit(error) => error,
        };
        let mut words = error.to_string();
        let mut cause = error.source();
        while let Some(error) = cause {
            // Some messages already include their cause.
            let more = error.to_string();
            if !words.contains(&more) {
                words = format!("{words}: {more}");
            }
            cause = error.source();
        }
        words
    }
}

/// Appends the option that resolves it to a bad-input error; other errors are unchanged.
pub(crate) fn with_option(error: Error, option: &str) -> Error {
    match error {
        Error::Input { path, line, field, found, expected } => {
            Error::Input { path, line, field, found, expected: format!("{expected} ({option})") }
        }
        Error::Setting { field, found, expected } => {
            Error::Setting { field, found, expected: format!("{expected} ({option})") }
        }
        other => other,
    }
}
