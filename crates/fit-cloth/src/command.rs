//! The commands, one file each.

pub mod import;
pub mod rig;
pub mod stretch;

use crate::failure::Failure;
use crate::options::{Command, Options, Telling};
use serde_json::Value;
use std::io::Write;

/// How a command that could be carried out has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// As it should.
    Done,
    /// With a result that is written, but marked as not converged.
    NotConverged,
}

/// Carries out a command and writes its result to `output`.
///
/// # Errors
/// What stopped it.
pub fn run(options: &Options, output: &mut impl Write) -> Result<Outcome, Failure> {
    match &options.command {
        Command::Import(import) => import::run(import, options.telling, output),
        Command::Rig(rig) => rig::run(rig, options.telling, output),
        Command::Stretch(stretch) => stretch::run(stretch, options.telling, output),
    }
}

/// Writes a result for a reader or, if asked for, as one JSON object.
fn tell(telling: Telling, output: &mut impl Write, text: &str, json: &Value) -> Result<(), Failure> {
    if telling.json {
        writeln!(output, "{json}")?;
    } else if !telling.quiet {
        writeln!(output, "{text}")?;
    }
    Ok(())
}
