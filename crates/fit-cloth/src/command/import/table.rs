//! `fit-cloth import table`: converts force over elongation into stress over strain.

use super::curve::print_curve;
use super::selection::{ExtensionOptions, column, rows};
use crate::failure::Failure;
use crate::outcome::Outcome;
use crate::output::write;
use crate::printing::{Printing, note_lines_above};
use clap::{Args, ValueEnum};
use cloth_data::strip::{Column, Conversion, ForceTable, read_force_table};
use cloth_sim::material::{Component, Compression, Model};
use std::io::Write;
use std::ops::RangeInclusive;
use std::path::PathBuf;

const EXAMPLE: &str = "\
COLUMN is the exact name in the header; the unit is the end of that name (travel_mm, Load (N), Strain [%]) or follows a \
colon (load:N). Rows must ascend: select one loading of a cyclic test with --rows.

Example:
  fit-cloth import table fixtures/curves/pull.csv --width-m 0.05 --gauge-m 0.2 \\
    --force load_N --displacement travel_mm --measure green --out pulled.csv";

/// `fit-cloth import table`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE, allow_negative_numbers = true)]
pub struct TableOptions {
    /// The table: comma-separated values with a header
    pub file: PathBuf,
    /// Width of the strip at rest, across the pull; for a sheared sheet, along the bars
    #[arg(long, value_name = "M")]
    pub width_m: f64,
    /// Clamp distance at rest; not needed with --strain
    #[arg(long, value_name = "M")]
    pub gauge_m: Option<f64>,
    /// Extension of the strip, or shift of the bars.
    #[command(flatten)]
    pub extension: ExtensionOptions,
    /// Column of the load cell's reading
    #[arg(long, value_name = "COLUMN[:UNIT]", value_parser = column)]
    pub force: Column,
    /// Rows to use, such as 3-90 or 3-, both ends included; 1 is the first below the header [default: all]
    #[arg(long, value_name = "FIRST-LAST", value_parser = rows)]
    pub rows: Option<RangeInclusive<usize>>,
    /// Strain and stress measure to write: that of the model that will read the curve
    #[arg(long, value_enum)]
    pub measure: MeasureChoice,
    /// Tension per width across the bars of a shear tester; its contribution to the force is subtracted
    #[arg(long, value_name = "N_PER_M", default_value_t = 0.0)]
    pub tension_n_per_m: f64,
    /// Output file for the curve
    #[arg(long, value_name = "OUT")]
    pub out: PathBuf,
}

/// Strain and stress measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MeasureChoice {
    /// Green strain, second Piola-Kirchhoff stress F/(w λ): model stvk
    Green,
    /// Engineering strain, nominal stress F/w: models soft-constraint and springs
    Engineering,
    /// Shear between parallel bars, F/w: all models
    Shear,
}

/// Converts a table into a curve.
///
/// # Errors
/// A bad table or option; I/O errors.
pub fn run(options: &TableOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let tension = options.tension_n_per_m;
    let (conversion, component, model, words) = match options.measure {
        MeasureChoice::Green => {
            (Conversion::Green, Component::StretchWeft, Model::STVK, "Green strain, for the model stvk")
        }
        MeasureChoice::Engineering => {
            let words = "engineering strain, for the models soft-constraint and springs";
            (Conversion::Engineering, Component::StretchWeft, Model::SOFT_CONSTRAINT, words)
        }
        MeasureChoice::Shear => {
            (Conversion::Shear { tension }, Component::Shear, Model::STVK, "shear, for all models")
        }
    };
    let test = ForceTable {
        width: options.width_m,
        gauge: options.gauge_m,
        extension: options.extension.chosen(),
        force: options.force.clone(),
        rows: options.rows.clone(),
        conversion,
    };
    let file = read_force_table(&options.file, &test)?;
    note_lines_above(printing, &options.file, &test.columns())?;
    let curve = file.curve(component, model, model.negative_strain(component, Compression::ZeroStrain))?;
    write("--out", &options.out, &options.file, &file.to_csv())?;
    print_curve(printing, output, &file, &curve, (component, model, words), &options.out)
}
