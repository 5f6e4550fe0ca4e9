//! The commands, one file each.

pub mod check;
pub mod compare;
pub mod curve;
pub mod fit;
pub mod goal;
pub mod import;
pub mod report;
pub mod rig;
pub mod simulate;
pub mod study;
pub mod validate;

use crate::failure::Failure;
use crate::options::{Command, Options, Telling};
use cloth_fit::io::table::lines_above_header;
use cloth_fit::store::Recalled;
use cloth_sim::curve::soundness::Finding;
use cloth_sim::material::Component;
use goal::Goal;
use serde::Serialize;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// How a command that could be carried out has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// As it should.
    Done,
    /// The check was made, and what was checked has a defect.
    Defective,
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
        Command::Stretch(flags) => fit::run(Goal::Stretch, flags, options.telling, output),
        Command::Shear(flags) => fit::run(Goal::Shear, flags, options.telling, output),
        Command::Bend(flags) => fit::run(Goal::Bend, flags, options.telling, output),
        Command::Fit(flags) => fit::run(Goal::All, flags, options.telling, output),
        Command::Check(check) => check::run(check, options.telling, output),
        Command::Curve(curve) => curve::run(curve, options.telling, output),
        Command::Compare(compare) => compare::run(compare, options.telling, output),
        Command::Simulate(simulate) => simulate::run(simulate, options.telling, output),
        Command::Report(report) => report::run(report, options.telling, output),
        Command::Study(study) => study::run(study, options.telling, output),
        Command::Validate(validate) => validate::run(validate, options.telling, output),
    }
}

/// Which program this is: a journal of another one is of no use. A build in development keeps its version number, so
/// the file's age and size count too.
fn program() -> impl Serialize {
    let file = std::env::current_exe().and_then(std::fs::metadata).ok();
    let file = file.map(|file| (file.len(), file.modified().ok()));
    (env!("CARGO_PKG_VERSION"), file)
}

/// The records of a run that was stopped; says on standard error that they are used, or not.
fn recalled<T>(recalled: Recalled<T>, telling: Telling, name: impl Fn(&T) -> String) -> Vec<T> {
    let Recalled { records, forgotten } = recalled;
    if forgotten {
        warn(
            telling,
            "what an interrupted run had finished was of other input or settings, and is forgotten",
        );
    }
    if !records.is_empty() {
        let names: Vec<String> = records.iter().map(name).collect();
        note(telling, &format!("going on after what an interrupted run has finished: {}", names.join("; ")));
    }
    records
}

/// Says on standard error what the user should know, though the command goes on.
fn warn(telling: Telling, warning: &str) {
    note(telling, &format!("warning: {warning}"));
}

/// Warns of what `check` finds wrong with curves that are made or used.
fn warn_of_defects(telling: Telling, what: &str, findings: &[(Component, Vec<Finding>)]) {
    for (component, findings) in findings {
        for finding in findings.iter().filter(|finding| finding.is_defect()) {
            warn(telling, &format!("{what}, {component}: {finding}: {}", finding.consequence()));
        }
    }
}

/// Says on standard error that lines above a table's header were passed over.
fn note_lines_above(telling: Telling, path: &Path, columns: &[&str]) -> Result<(), Failure> {
    match lines_above_header(path, columns)? {
        0 => {}
        1 => note(telling, &format!("{}: a line above the header is passed over", path.display())),
        lines => {
            note(telling, &format!("{}: {lines} lines above the header are passed over", path.display()))
        }
    }
    Ok(())
}

/// Says something on standard error.
fn note(telling: Telling, text: &str) {
    if !telling.quiet {
        // Nobody may be there to read it.
        let _ = writeln!(std::io::stderr(), "{text}");
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
