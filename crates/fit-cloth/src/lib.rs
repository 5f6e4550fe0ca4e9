//! The command line of fit-cloth: from its arguments to an exit code.
//!
//! | exit code | means |
//! |---|---|
//! | 0 | done, and converged where something was solved |
//! | 1 | the operating system refused |
//! | 2 | the command line makes no sense |
//! | 3 | bad input: a file, a measurement or a setting; a curve that `check` finds a defect in |
//! | 4 | not converged; what was reached is written, and marked so |
//! | 130 | interrupted |
//!
//! | module | role |
//! |---|---|
//! | [`cli`] | all commands with their arguments |
//! | [`command`] | the commands, one file each |
//! | [`options`] | the flags that commands share |
//! | [`subject`] | the curves that `check` and `curve` work on |
//! | [`text`], [`plot`], [`page`] | what was found: in words, as figures, as a page |
//! | [`telling`], [`output`], [`progress`] | standard output and standard error; files, whole or not at all; how far it is |
//! | [`outcome`], [`failure`] | how a command has ended, or why it could not be carried out |

pub mod cli;
pub mod command;
pub mod failure;
mod interrupt;
pub mod options;
pub mod outcome;
pub mod output;
pub mod page;
pub mod plot;
pub mod progress;
mod shown;
pub mod subject;
pub mod telling;
pub mod text;

use clap::Parser;
use cli::Options;
use failure::Failure;
use outcome::Outcome;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

/// Runs the program on its arguments, its standard output and its standard error.
pub fn main() -> ExitCode {
    if let Err(error) = interrupt::install() {
        let _ = writeln!(io::stderr(), "error: no handler for interrupts: {error}");
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
            // Help that nobody reads is no failure, and there is nowhere to tell of one on standard error.
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

/// Goes on where nobody reads: a reader that has read enough, such as `head`, changes neither result nor exit code.
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
