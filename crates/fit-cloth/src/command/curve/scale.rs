//! `fit-cloth curve scale`: multiplies strains and stresses by factors.

use super::edited::{finish, in_material, one};
use crate::failure::Failure;
use crate::file_curve::Source;
use crate::options::Reading;
use crate::outcome::Outcome;
use crate::printing::Printing;
use clap::Args;
use cloth_data::curve_edit::{largest_stress, scaled};
use std::io::Write;
use std::path::PathBuf;

const EXAMPLE: &str = "\
Larger strains make the cloth softer, larger stresses make it stiffer. The edits of Strohkorb 2019, \
figure 8 (weft steps 10 times as large, warp 200 times, shear 10 times) and figure 11 (largest shear stress \
raised from 60 to 100, all others in proportion; here from 16 to 27):

Examples:
  fit-cloth curve scale fixtures/curves/weft.csv --strain 10 --out weft-loose.csv
  fit-cloth curve scale fixtures/curves/warp.csv --strain 200 --out warp-loose.csv
  fit-cloth curve scale fixtures/curves/shear.csv --component shear --strain 10 \\
    --out shear-loose.csv
  fit-cloth curve scale fixtures/curves/shear.csv --component shear --largest-stress 27 \\
    --out shear-stiff.csv";

/// `fit-cloth curve scale`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE, allow_negative_numbers = true)]
pub struct ScaleOptions {
    /// A table of one curve, or a material.json (with --component)
    pub file: PathBuf,
    /// Multiply all strains (curvatures) by this
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub strain: f64,
    /// Multiply all stresses (moments) by this
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub stress: f64,
    /// Scale all stresses (moments) so that the largest has this value, in N/m (N)
    #[arg(long, value_name = "STRESS", conflicts_with = "stress")]
    pub largest_stress: Option<f64>,
    /// Output file, in the format of FILE
    #[arg(long, value_name = "OUT")]
    pub out: PathBuf,
    /// Component and model.
    #[command(flatten)]
    pub reading: Reading,
}

/// Scales a curve.
///
/// # Errors
/// A bad file or factor; I/O errors.
pub fn run(options: &ScaleOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let (source, subject) = one(&options.file, &options.reading)?;
    let stress = match options.largest_stress {
        Some(largest) => largest / largest_stress(&subject.curve),
        None => options.stress,
    };
    let edited = scaled(&subject.curve, options.strain, stress)?;
    let change = format!("strains scaled by {}, stresses by {stress}", options.strain);
    let text = match source {
        Source::Material(file) => in_material(*file, &subject, &edited, &change),
        Source::Table(file) => {
            let scaled = file.scaled(options.strain, stress);
            // In some models the compressive side does not scale by the same factors.
            if file.is_two_sided() { scaled.with_curve(&edited) } else { scaled }.to_csv()
        }
    };
    finish([&options.file, &options.out], &subject, (&edited, &text), printing, output)
}
