//! Reading a curve to edit and writing it back.

use crate::failure::Failure;
use crate::file_curve::{FileCurve, Source, read};
use crate::options::Reading;
use crate::outcome::Outcome;
use crate::output::write;
use crate::printing::{Printing, print_result, warn};
use cloth_data::curve_edit::largest_stress;
use cloth_data::error::Error;
use cloth_fit::material::file::MaterialFile;
use cloth_sim::curve::StiffnessCurve;
use cloth_sim::curve::soundness::{Context, Finding, check};
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Reads the one curve to edit.
pub(super) fn one(path: &Path, reading: &Reading) -> Result<(Source, FileCurve), Failure> {
    let (source, mut subjects) = read(path, reading.component(), reading.model())?;
    match (subjects.pop(), subjects.is_empty()) {
        (Some(subject), true) => Ok((source, subject)),
        (last, _) => {
            let names = subjects.iter().chain(&last).map(|subject| subject.name.clone());
            let found = names.collect::<Vec<_>>().join(", ");
            Err(Error::input(path, None, "curves", found, "--component, to select one of them").into())
        }
    }
}

/// The text of a material file with one curve replaced.
pub(super) fn in_material(
    mut file: MaterialFile,
    subject: &FileCurve,
    edited: &StiffnessCurve,
    change: &str,
) -> String {
    file.set_curve(subject.component, edited, change);
    file.to_json()
}

/// Writes an edited curve, prints its range before and after, and warns of its defects.
pub(super) fn finish(
    [input, out]: [&Path; 2],
    subject: &FileCurve,
    (edited, text): (&StiffnessCurve, &str),
    printing: Printing,
    output: &mut impl Write,
) -> Result<Outcome, Failure> {
    write("--out", out, input, text)?;
    let context = Context { visited: None, ..subject.context };
    let findings = check(edited, &context);
    let defects: Vec<&Finding> = findings.iter().filter(|finding| finding.is_defect()).collect();
    for finding in &defects {
        let scale = subject.strain_per_unit;
        let shown = Finding { strains: finding.strains.map(|strain| strain / scale), ..**finding };
        warn(printing, &format!("{}: {shown}: {}", subject.name, finding.consequence()));
    }
    let describe = |curve: &StiffnessCurve| {
        let last = curve.strains()[curve.len() - 1] / subject.strain_per_unit;
        format!("{} points, to {last:.4} and {:.4} {}", curve.len(), largest_stress(curve), subject.unit)
    };
    let sound =
        if defects.is_empty() { "sound" } else { "NOT sound: repair it with fit-cloth check --repair" };
    let words = format!(
        "{} was: {}\n{:width$} is:  {}\n{sound}\nWritten to {}",
        subject.name,
        describe(&subject.curve),
        "",
        describe(edited),
        out.display(),
        width = subject.name.len()
    );
    let json = json!({
        "written": out.display().to_string(),
        "points": edited.len(),
        "last_strain": edited.strains()[edited.len() - 1] / subject.strain_per_unit,
        "largest_stress": largest_stress(edited),
        "sound": defects.is_empty(),
    });
    print_result(printing, output, &words, &json)?;
    Ok(Outcome::Done)
}
