//! Check and report of an imported curve.

use crate::failure::Failure;
use crate::outcome::Outcome;
use crate::printing::{Printing, print_result, warn};
use cloth_data::curve_edit::largest_stress;
use cloth_data::curve_file::CurveFile;
use cloth_fit::material::check::context;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::curve::soundness::{Finding, check};
use cloth_sim::material::{Component, Model};
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Checks a curve that was written, and prints its range and its defects.
///
/// * `words` — its measure
/// * `out` — the file that it was written to
pub(super) fn print_curve(
    printing: Printing,
    output: &mut impl Write,
    file: &CurveFile,
    curve: &StiffnessCurve,
    (component, model, words): (Component, Model, &str),
    out: &Path,
) -> Result<Outcome, Failure> {
    let findings = check(curve, &context(model, component, None));
    let defects: Vec<&Finding> = findings.iter().filter(|finding| finding.is_defect()).collect();
    for finding in &defects {
        warn(printing, &format!("{finding}: {}", finding.consequence()));
    }
    let strain = [file.strains[0], file.strains[file.strains.len() - 1]];
    let largest = largest_stress(curve);
    let sound =
        if defects.is_empty() { "sound" } else { "NOT sound: repair it with fit-cloth check --repair" };
    let text = format!(
        "{} rows, strain {:.4} to {:.4}, stress up to {largest:.4} N/m: {words}\n{sound}\nWritten to {}",
        file.strains.len(),
        strain[0],
        strain[1],
        out.display()
    );
    let json = json!({
        "written": out.display().to_string(),
        "rows": file.strains.len(),
        "strain": strain,
        "largest_stress_n_per_m": largest,
        "sound": defects.is_empty(),
    });
    print_result(printing, output, &text, &json)?;
    Ok(Outcome::Done)
}
