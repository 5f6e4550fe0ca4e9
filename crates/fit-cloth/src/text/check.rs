//! The result of a check: a table of findings, the repairs, a verdict.

use super::list::list;
use crate::file_curve::FileCurve;
use cloth_fit::judge::repair::Repair;
use cloth_sim::curve::soundness::{Finding, Flaw};
use std::fmt::Write;
use std::path::Path;

/// One row per finding, then the repairs and the verdict.
///
/// * `findings` — one list per subject
/// * `repairs` — one per subject, if requested and written to `out`
pub fn check(
    file: &Path,
    subjects: &[FileCurve],
    findings: &[Vec<Finding>],
    repairs: Option<&[Repair]>,
    out: Option<&Path>,
) -> String {
    let axis = subjects.first().map_or("strain", |subject| subject.axis);
    let several = subjects.iter().any(|subject| subject.axis != axis);
    let axis = if several { "strain" } else { axis };
    let width = subjects.iter().map(|subject| subject.name.len()).max().unwrap_or_default().max(5);
    let mut text = format!(
        "{:width$}  {:18}  {:8}  {axis:18}  {:>10}  {:>10}  in a simulation\n",
        "curve", "finding", "severity", "value", "limit"
    );
    for (subject, found) in subjects.iter().zip(findings) {
        if found.is_empty() {
            let _ = writeln!(text, "{:width$}  {:18}  {:8}  {}", subject.name, "none", "-", range(subject));
        }
        for finding in found {
            let _ = writeln!(text, "{:width$}  {}", subject.name, row(subject, finding));
        }
    }
    text.push('\n');
    for (subject, repair) in subjects.iter().zip(repairs.into_iter().flatten()) {
        let _ = writeln!(text, "{}: {}", subject.name, repaired(subject, repair));
    }
    text + &verdict(file, subjects, findings, out)
}

/// Describes a repair.
pub fn repaired(subject: &FileCurve, repair: &Repair) -> String {
    if repair.is_unchanged() {
        return "sound, unchanged".into();
    }
    format!(
        "repaired: stress changed by {:.3e} {unit} rms, {:.3e} {unit} at most, at {} {:.4}",
        repair.rms,
        repair.largest,
        subject.axis,
        repair.at / subject.strain_per_unit,
        unit = subject.unit
    )
}

fn row(subject: &FileCurve, finding: &Finding) -> String {
    let scale = subject.strain_per_unit;
    let [low, high] = finding.strains.map(|strain| strain / scale);
    let interval =
        if high.is_finite() { format!("{low:.4} to {high:.4}") } else { format!("{low:.4} and beyond") };
    let [value, limit] = match finding.kind {
        Flaw::Unvisited => [format!("{:.0} %", 100.0 * finding.value), "-".into()],
        Flaw::TangentRatio => [finding.value, finding.limit].map(|ratio| format!("{ratio:.2e}")),
        _ => [finding.value, finding.limit].map(|stiffness| format!("{:.2e}", scale * stiffness)),
    };
    let (kind, severity) = (finding.kind, finding.severity());
    format!("{kind:18}  {severity:8}  {interval:18}  {value:>10}  {limit:>10}  {}", finding.consequence())
}

/// Range of the control points.
fn range(subject: &FileCurve) -> String {
    let strains = subject.curve.strains();
    format!("0.0000 to {:.4}", strains[strains.len() - 1] / subject.strain_per_unit)
}

fn verdict(file: &Path, subjects: &[FileCurve], findings: &[Vec<Finding>], out: Option<&Path>) -> String {
    let defects = findings.iter().flatten().filter(|finding| finding.is_defect()).count();
    let bad = subjects.iter().zip(findings).filter(|(_, found)| found.iter().any(Finding::is_defect));
    let names = list(bad.map(|(subject, _)| &subject.name));
    let written = out.map(|out| format!("\nWritten to {}", out.display())).unwrap_or_default();
    let (file, plural) = (file.display(), if defects == 1 { "" } else { "s" });
    match (defects, out) {
        (0, _) => format!("{file}: sound{written}"),
        (_, Some(_)) => {
            format!(
                "{file}: NOT sound, {defects} defect{plural} in {names}; --repair wrote sound curves{written}"
            )
        }
        (_, None) => format!(
            "{file}: NOT sound, {defects} defect{plural} in {names}; --repair OUT writes the nearest stable curve"
        ),
    }
}
