//! `fit-cloth curve`: edits a curve.

mod edited;
pub mod extend;
pub mod scale;

use crate::failure::Failure;
use crate::outcome::Outcome;
use crate::printing::Printing;
use clap::{Args, Subcommand};
use extend::ExtendOptions;
use scale::ScaleOptions;
use std::io::Write;

const EXAMPLE: &str = "\
Examples:
  fit-cloth curve scale fixtures/curves/weft.csv --strain 10 --out softer.csv
  fit-cloth curve extend fixtures/curves/weft.csv --to 0.2 --out longer.csv

fit-cloth curve scale --help and fit-cloth curve extend --help explain every option.";

/// `fit-cloth curve`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct Curve {
    /// The edit.
    #[command(subcommand)]
    pub edit: CurveEdit,
}

/// The edits.
#[derive(Debug, Clone, Subcommand)]
pub enum CurveEdit {
    /// Multiply all strains, all stresses, or both
    Scale(ScaleOptions),
    /// Extend a curve with a straight piece, from its last strain or an earlier one
    Extend(ExtendOptions),
}

/// Edits a curve.
///
/// # Errors
/// A bad file or option; I/O errors.
pub fn run(curve: &Curve, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    match &curve.edit {
        CurveEdit::Scale(options) => scale::run(options, printing, output),
        CurveEdit::Extend(options) => extend::run(options, printing, output),
    }
}
