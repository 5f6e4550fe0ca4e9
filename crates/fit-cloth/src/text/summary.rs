//! All curves at a glance.

use super::{list, seen};
use cloth_fit::incremental::FitReport;
use cloth_fit::report::{Sample, StageReport};
use cloth_sim::material::Component;
use std::fmt::Write;

/// One row a component: its curve at the end of the range that was seen.
pub fn summary(report: &FitReport) -> String {
    let mut text = String::from(
        "curve          points  at the end of the range           ± 95 %  range seen             observed by\n",
    );
    for component in Component::ALL {
        let _ = match report.stage(component).filter(|stage| stage.curve.observed) {
            Some(stage) => writeln!(text, "{component:13}  {}", row(stage)),
            None if report.knowledge.knows(component) => writeln!(text, "{component:13}  given"),
            None => writeln!(text, "{component:13}  not observed"),
        };
    }
    text
}

fn row(stage: &StageReport) -> String {
    let end = &stage.curve.samples[stage.curve.samples.len() - 1];
    let (what, unit, per) = match stage.components[0].is_bending() {
        true => ("moment", "N", " 1/m"),
        false => ("stress", "N/m", ""),
    };
    let range = seen(stage) + per;
    let value = format!("{what} {:.4e} {unit}", end.stress);
    let points = stage.curve.curve.len();
    let seen_by = list(stage.sequences.iter().map(|sequence| &sequence.name));
    format!("{points:6}  {value:28}  {:>9}  {range:21}  {seen_by}", band(end))
}

fn band(sample: &Sample) -> String {
    match sample.band {
        Some([low, high]) if sample.stress != 0.0 => {
            format!("{:.1} %", 50.0 * (high - low) / sample.stress.abs())
        }
        _ => "not known".into(),
    }
}

/// That the published method was used, and what that does to bending.
pub fn as_published(report: &FitReport) -> String {
    let bends = report.stages.iter().any(|stage| stage.components[0].is_bending());
    let bias = "; held only where it lies on the table, a sheet comes out a third or more too stiff";
    format!("{}, fitted as published (Miguel et al. 2012){}", report.model, if bends { bias } else { "" })
}

/// Why a component has no curve; `None` if it has one.
pub fn missing(report: &FitReport, component: Component) -> Option<String> {
    if report.knowledge.knows(component) {
        return None;
    }
    let failed = report.failures.iter().any(|failure| failure.components.contains(&component));
    Some(match report.stage(component) {
        None if failed => format!("{component} has no curve: its stage failed"),
        None => format!("{component} is not observed: no sequence shows it; it has no curve"),
        Some(stage) => {
            let names = list(stage.sequences.iter().map(|sequence| &sequence.name));
            format!(
                "{component} is not observed: the measurements of {names} do not tell its scale; it has no curve"
            )
        }
    })
}
