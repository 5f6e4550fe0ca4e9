//! `fit-cloth check`: checks curves for simulation and repairs them.

use crate::failure::Failure;
use crate::file_curve::{FileCurve, Source, read};
use crate::options::Reading;
use crate::outcome::Outcome;
use crate::output::write;
use crate::printing::{Printing, print_result};
use crate::text;
use clap::Args;
use cloth_data::error::Error;
use cloth_fit::judge::repair::{Repair, repair};
use cloth_sim::curve::soundness::{Finding, Flaw};
use serde_json::{Map, Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Help text after the options.
pub const EXAMPLE: &str = "\
Exit code: 0 if FILE is sound, 3 if it has a defect, even when --repair has written a sound curve.

Examples:
  fit-cloth check fixtures/curves/weft.csv
  fit-cloth check fixtures/curves/kinked.csv --repair mended.csv
  fit-cloth check mended.csv
  fit-cloth check fixtures/curves/shear.csv --component shear";

/// `fit-cloth check`.
#[derive(Debug, Clone, Args)]
#[command(after_help = EXAMPLE)]
pub struct CheckOptions {
    /// A material.json, or a table of one curve: strain,stress_n_per_m or curvature_per_m,moment_n
    pub file: PathBuf,
    /// Write the nearest sound curves, in the format of FILE
    #[arg(long, value_name = "OUT")]
    pub repair: Option<PathBuf>,
    /// Component and model.
    #[command(flatten)]
    pub reading: Reading,
}

/// Checks curves, and repairs them if requested.
///
/// # Errors
/// A bad file; a curve that cannot be repaired; I/O errors.
pub fn run(options: &CheckOptions, printing: Printing, output: &mut impl Write) -> Result<Outcome, Failure> {
    let (source, subjects) = read(&options.file, options.reading.component(), options.reading.model())?;
    let repairs = match &options.repair {
        Some(out) => Some(write_repairs(options, out, source, &subjects)?),
        None => None,
    };
    let findings: Vec<Vec<Finding>> = subjects.iter().map(FileCurve::findings).collect();
    let sound = findings.iter().flatten().all(|finding| !finding.is_defect());
    let words =
        text::check(&options.file, &subjects, &findings, repairs.as_deref(), options.repair.as_deref());
    let json = json(options, &subjects, &findings, repairs.as_deref());
    print_result(printing, output, &words, &json)?;
    Ok(if sound { Outcome::Done } else { Outcome::Defective })
}

/// Repairs the curves and writes them.
fn write_repairs(
    options: &CheckOptions,
    out: &Path,
    source: Source,
    subjects: &[FileCurve],
) -> Result<Vec<Repair>, Failure> {
    let repairs: Vec<Repair> = subjects
        .iter()
        .map(|subject| {
            repair(&subject.curve, &subject.context).map_err(|reason| {
                let expected = "a curve that can be repaired; nothing is written";
                Error::input(&options.file, None, &subject.name, reason.to_string(), expected)
            })
        })
        .collect::<Result<_, _>>()?;
    let text = match source {
        Source::Table(file) => match &repairs[..] {
            [repair] if !repair.is_unchanged() => file.with_curve(&repair.curve).to_csv(),
            _ => file.to_csv(),
        },
        Source::Material(mut file) => {
            for (subject, repair) in
                subjects.iter().zip(&repairs).filter(|(_, repair)| !repair.is_unchanged())
            {
                file.set_curve(subject.component, &repair.curve, &text::repaired(subject, repair));
            }
            file.to_json()
        }
    };
    write("--repair", out, &options.file, &text)?;
    Ok(repairs)
}

fn json(
    options: &CheckOptions,
    subjects: &[FileCurve],
    findings: &[Vec<Finding>],
    repairs: Option<&[Repair]>,
) -> Value {
    let curve = |(index, subject): (usize, &FileCurve)| {
        let scale = subject.strain_per_unit;
        let finding = |finding: &Finding| {
            // Stiffnesses are converted to the file's strain; ratios and shares are dimensionless. JSON has no
            // infinity.
            let factor =
                if matches!(finding.kind, Flaw::TangentRatio | Flaw::Unvisited) { 1.0 } else { scale };
            let strains =
                finding.strains.map(|strain| Some(strain / scale).filter(|strain| strain.is_finite()));
            json!({
                "kind": finding.kind.to_string(),
                "severity": finding.severity().to_string(),
                "strain": strains,
                "value": factor * finding.value,
                "limit": factor * finding.limit,
                "consequence": finding.consequence(),
            })
        };
        let mut entry = json!({
            "sound": findings[index].iter().all(|finding| !finding.is_defect()),
            "findings": findings[index].iter().map(finding).collect::<Vec<_>>(),
        });
        if let Some(repair) = repairs.and_then(|repairs| repairs.get(index)) {
            entry["repair"] = json!({
                "rms_stress": repair.rms,
                "largest_stress": repair.largest,
                "at_strain": repair.at / scale,
            });
        }
        (subject.name.clone(), entry)
    };
    json!({
        "file": options.file.display().to_string(),
        "sound": findings.iter().flatten().all(|finding| !finding.is_defect()),
        "curves": Value::Object(subjects.iter().enumerate().map(curve).collect::<Map<_, _>>()),
        "repaired": options.repair.as_ref().map(|path| path.display().to_string()),
    })
}
