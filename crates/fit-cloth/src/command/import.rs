//! `fit-cloth import`: converts a laboratory's table into a measurement set or a curve.

mod curve;
pub mod selection;
pub mod strip;
pub mod table;

use crate::failure::Failure;
use crate::outcome::Outcome;
use crate::printing::Printing;
use clap::{Args, Subcommand};
use std::io::Write;
use strip::StripOptions;
use table::TableOptions;

const EXAMPLE: &str = "\
Example:
  fit-cloth import strip weft.csv --set cotton-knit --name cotton-knit \\
    --areal-density-kg-m2 0.3 --direction weft --gauge-m 0.08 --width-m 0.04 \\
    --separation clamp_distance_m --force force_N

fit-cloth import strip --help and fit-cloth import table --help explain every option.";

/// `fit-cloth import`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct Import {
    /// The kind of table.
    #[command(subcommand)]
    pub table: ImportTable,
}

/// The tables that can be imported.
#[derive(Debug, Clone, Subcommand)]
pub enum ImportTable {
    /// Import a tensile machine's table, of a strip pulled between two clamps, into a set
    Strip(StripOptions),
    /// Convert force over elongation of a strip or a shear test into a stress-strain curve, without a fit
    Table(TableOptions),
}

/// Imports a table.
///
/// # Errors
/// A bad table, set or option; I/O errors.
pub fn run(import: &Import, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    match &import.table {
        ImportTable::Strip(options) => strip::run(options, printing, output),
        ImportTable::Table(options) => table::run(options, printing, output),
    }
}
