//! `fit-cloth curve extend`: appends a straight piece to the stress-strain curve.

use super::edited::{finish, in_material, one};
use crate::failure::Failure;
use crate::file_curve::Source;
use crate::options::Reading;
use crate::outcome::Outcome;
use crate::printing::Printing;
use clap::Args;
use cloth_data::curve_edit::{Extension, Trend, extended};
use std::io::Write;
use std::path::PathBuf;

const EXAMPLE: &str = "\
The straight piece continues with the last tangent, as a curve does in a simulation, unless --slope or --stress-at-end is \
given. With --from, it replaces the curve beyond that strain.

The edits of Strohkorb 2019, figure 9 (weft: a linear trend from half its range on, and twice the greatest stress) and \
figure 10 (warp: strain steps 10 times as large, then the same), applied to the fixtures:

Examples:
  fit-cloth curve extend fixtures/curves/weft.csv --from 0.057 --to 0.1 \\
    --stress-at-end 950 --out weft-trend.csv
  fit-cloth curve scale fixtures/curves/warp.csv --strain 10 --out warp-wide.csv
  fit-cloth curve extend warp-wide.csv --from 0.08 --to 0.13 --stress-at-end 400 \\
    --out warp-trend.csv
  fit-cloth curve extend fixtures/curves/bend.csv --to 150 --slope 2e-6 --points 5 \\
    --out bend-trend.csv";

/// `fit-cloth curve extend`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE, allow_negative_numbers = true)]
pub struct ExtendOptions {
    /// A table of one curve, or a material.json (with --component)
    pub file: PathBuf,
    /// Strain (curvature) at which the straight piece ends
    #[arg(long, value_name = "STRAIN")]
    pub to: f64,
    /// Strain (curvature) at which the straight piece begins [default: the curve's last]
    #[arg(long, value_name = "STRAIN")]
    pub from: Option<f64>,
    /// Slope of the straight piece [default: the curve's tangent where it begins]
    #[arg(long, value_name = "N_PER_M")]
    pub slope: Option<f64>,
    /// Stress (moment) at the end of the straight piece
    #[arg(long, value_name = "STRESS", conflicts_with = "slope")]
    pub stress_at_end: Option<f64>,
    /// Number of points to add [default: at the mean spacing of the curve's points]
    #[arg(long, value_name = "COUNT")]
    pub points: Option<usize>,
    /// Output file, in the format of FILE
    #[arg(long, value_name = "OUT")]
    pub out: PathBuf,
    /// Component and model.
    #[command(flatten)]
    pub reading: Reading,
}

/// Extends a curve.
///
/// # Errors
/// A bad file or option; I/O errors.
pub fn run(options: &ExtendOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let (source, subject) = one(&options.file, &options.reading)?;
    let scale = subject.strain_per_unit;
    let trend = match (options.slope, options.stress_at_end) {
        (Some(slope), _) => Trend::Slope(slope / scale),
        (None, Some(stress)) => Trend::StressAtEnd(stress),
        (None, None) => Trend::Tangent,
    };
    let from = options.from.map(|strain| scale * strain);
    let extension = Extension { from, to: scale * options.to, trend, points: options.points };
    let edited = extended(&subject.curve, &extension)?;
    let text = match source {
        Source::Table(file) => file.with_points(&edited).to_csv(),
        Source::Material(file) => {
            let last = subject.curve.strains()[subject.curve.len() - 1];
            let change = format!("straight from strain {} to {}", from.unwrap_or(last), options.to);
            in_material(*file, &subject, &edited, &change)
        }
    };
    finish([&options.file, &options.out], &subject, (&edited, &text), printing, output)
}
