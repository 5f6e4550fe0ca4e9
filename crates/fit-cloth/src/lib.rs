//! The command line of fit-cloth.
//!
//! | exit code | means |
//! |---|---|
//! | 0 | success; everything solved has converged |
//! | 1 | I/O error |
//! | 2 | invalid command line |
//! | 3 | bad input: a file, a measurement or a setting; a curve in which `check` finds a defect |
//! | 4 | not converged; the result is written and marked as such |
//! | 130 | interrupted |
//!
//! | module | role |
//! |---|---|
//! | [`cli`] | all commands with their arguments |
//! | [`command`] | the commands, one file each |
//! | [`options`] | flags shared by several commands |
//! | [`file_curve`] | the curves given to `check` and `curve` |
//! | [`text`], [`plot`], [`page`] | results as text, figures and an HTML page |
//! | [`printing`], [`output`], [`progress`] | standard output and error; atomic output; the progress line |
//! | [`outcome`], [`failure`] | the outcome of a completed command; the error that stopped one |

pub mod cli;
pub mod command;
pub mod failure;
pub mod file_curve;
mod interrupt;
pub mod options;
pub mod outcome;
pub mod output;
pub mod page;
pub mod plot;
pub mod printing;
pub mod progress;
mod shown;
pub mod text;

use clap::Parser;
use cli::Options;
use failure::Failure;
use outcome::Outcome;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

/// Runs the program on the process's arguments, standard output and standard error.
pub fn main() -> ExitCode {
    if let Err(error) = interrupt::install() {
        let _ = writeln!(io::stderr(), "error: cannot install the interrupt handler: {error}");
        return ExitCode::from(1);
    }
    let code = run();
    interrupt::settle();
    code
}

fn run() -> ExitCode {
    let options = match Options::try_parse() {
        Ok(options) => options,
        Err(error) => {
            // A closed pipe while printing help is not an error, and a failing standard error cannot be reported.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS };
        }
    };
    let mut output = Patient(io::stdout().lock());
    let outcome = cli::run(&options, &mut output);
    match outcome.and_then(|outcome| output.flush().map_err(Failure::from).map(|()| outcome)) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Defective) => ExitCode::from(3),
        Ok(Outcome::NotConverged) => ExitCode::from(4),
        Err(failure) => {
            let _ = writeln!(io::stderr(), "error: {}", failure.in_words());
            ExitCode::from(failure.exit_code())
        }
    }
}

/// A writer that ignores broken pipes: a reader that stops early, such as `head`, changes neither result nor exit code.
struct Patient<W>(W);

impl<W: Write> Write for Patient<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(bytes.len()),
            written => written,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            flushed => flushed,
        }
    }
}
