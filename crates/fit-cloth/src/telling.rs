//! How results, warnings and remarks are told.

use crate::failure::Failure;
use clap::Args;
use cloth_data::io::table::lines_above_header;
use cloth_sim::curve::soundness::Finding;
use cloth_sim::material::Component;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// Output flags of every command.
#[derive(Debug, Clone, Copy, Default, Args)]
#[command(next_help_heading = "Output")]
pub struct Telling {
    /// Print the result as one JSON object
    #[arg(long, global = true)]
    pub json: bool,
    /// Print errors only, and the JSON object of --json
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// Print every iteration
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
}

/// Says on standard error what the user should know, though the command goes on.
pub(crate) fn warn(telling: Telling, warning: &str) {
    note(telling, &format!("warning: {warning}"));
}

/// Warns of what `check` finds wrong with curves that are made or used.
pub(crate) fn warn_of_defects(telling: Telling, what: &str, findings: &[(Component, Vec<Finding>)]) {
    for (component, findings) in findings {
        for finding in findings.iter().filter(|finding| finding.is_defect()) {
            warn(telling, &format!("{what}, {component}: {finding}: {}", finding.consequence()));
        }
    }
}

/// Says on standard error that lines above a table's header were passed over.
pub(crate) fn note_lines_above(telling: Telling, path: &Path, columns: &[&str]) -> Result<(), Failure> {
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
pub(crate) fn note(telling: Telling, text: &str) {
    if !telling.quiet {
        // Nobody may be there to read it.
        let _ = writeln!(std::io::stderr(), "{text}");
    }
}

/// Writes a result for a reader or, if asked for, as one JSON object.
pub(crate) fn tell(
    telling: Telling,
    output: &mut impl Write,
    text: &str,
    json: &Value,
) -> Result<(), Failure> {
    if telling.json {
        writeln!(output, "{json}")?;
    } else if !telling.quiet {
        writeln!(output, "{text}")?;
    }
    Ok(())
}
