//! Printing of results, warnings and notes.

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
pub struct Printing {
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

/// Prints a warning on standard error.
pub(crate) fn warn(printing: Printing, warning: &str) {
    note(printing, &format!("warning: {warning}"));
}

/// Warns of the defects that a check found in curves written or used.
pub(crate) fn warn_of_defects(printing: Printing, what: &str, findings: &[(Component, Vec<Finding>)]) {
    for (component, findings) in findings {
        for finding in findings.iter().filter(|finding| finding.is_defect()) {
            warn(printing, &format!("{what}, {component}: {finding}: {}", finding.consequence()));
        }
    }
}

/// Notes on standard error how many lines above a table's header were skipped.
pub(crate) fn note_lines_above(printing: Printing, path: &Path, columns: &[&str]) -> Result<(), Failure> {
    match lines_above_header(path, columns)? {
        0 => {}
        1 => note(printing, &format!("{}: skipped 1 line above the header", path.display())),
        lines => note(printing, &format!("{}: skipped {lines} lines above the header", path.display())),
    }
    Ok(())
}

/// Prints a note on standard error, unless --quiet is given.
pub(crate) fn note(printing: Printing, text: &str) {
    if !printing.quiet {
        // Standard error may be closed.
        let _ = writeln!(std::io::stderr(), "{text}");
    }
}

/// Writes a result as text or, with --json, as one JSON object.
pub(crate) fn print_result(
    printing: Printing,
    output: &mut impl Write,
    text: &str,
    json: &Value,
) -> Result<(), Failure> {
    if printing.json {
        writeln!(output, "{json}")?;
    } else if !printing.quiet {
        writeln!(output, "{text}")?;
    }
    Ok(())
}
