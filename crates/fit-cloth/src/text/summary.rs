//! A summary of all curves.

use super::band::half_band;
use super::list::list;
use super::range::seen;
use cloth_fit::incremental::FitReport;
use cloth_fit::stage::report::{CurveRow, StageReport};
use cloth_sim::material::Component;
use std::fmt::Write;

/// One row per component: its curve at the end of the observed range.
pub fn summary(report: &FitReport) -> String {
    let mut text = String::from(
        "curve          points  at the end of the range           ± 95 %  range seen             observed by\n",
    );
    for [component, points, value, band, range, seen_by] in summary_rows(report) {
        let line = format!("{component:13}  {points:>6}  {value:28}  {band:>9}  {range:21}  {seen_by}");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Table cells: component, points, value at the end, band, range, sequences; cells that do not apply are empty.
pub fn summary_rows(report: &FitReport) -> Vec<[String; 6]> {
    let row = |component| match report.stage(component).filter(|stage| stage.curve.observed) {
        Some(stage) => row(component, stage),
        None => {
            let known = report.knowledge.knows(component);
            let why = if known { "given" } else { "not observed" };
            [component.to_string(), why.into(), String::new(), String::new(), String::new(), String::new()]
        }
    };
    report.model.components().into_iter().map(row).collect()
}

fn row(component: Component, stage: &StageReport) -> [String; 6] {
    let end = &stage.curve.samples[stage.curve.samples.len() - 1];
    let (what, unit, per) = match stage.components[0].is_bending() {
        true => ("moment", "N", " 1/m"),
        false => ("stress", "N/m", ""),
    };
    let range = seen(stage) + per;
    let value = format!("{what} {:.4e} {unit}", end.stress);
    let seen_by = list(stage.sequences.iter().map(|sequence| &sequence.name));
    [component.to_string(), stage.curve.curve.len().to_string(), value, band(end), range, seen_by]
}

fn band(sample: &CurveRow) -> String {
    half_band(sample).map_or("not known".into(), |half| format!("{:.1} %", 100.0 * half))
}

/// States that the published method was used, and its bias in bending.
pub fn as_published(report: &FitReport) -> String {
    let bends = report.stages.iter().any(|stage| stage.components[0].is_bending());
    let bias = "; bending comes out a third or more too stiff, since the sheet is held only where it lies on the table";
    format!("{}, fitted as published (Miguel et al. 2012){}", report.model, if bends { bias } else { "" })
}

/// States that curves are for one mesh.
///
/// * `side` — of its cells, m
pub fn for_mesh(side: f64) -> String {
    format!("Curves for a mesh with cells of {} mm: they make up for its error", 1e3 * side)
}

/// The reason why a component has no curve; `None` if it has one.
pub fn missing(report: &FitReport, component: Component) -> Option<String> {
    if report.knowledge.knows(component) {
        return None;
    }
    let failed = report.failures.iter().any(|failure| failure.components.contains(&component));
    Some(match report.stage(component) {
        None if failed => format!("{component} has no curve: its stage failed"),
        None => format!("{component} is not observed by any sequence; it has no curve"),
        Some(stage) => {
            let names = list(stage.sequences.iter().map(|sequence| &sequence.name));
            format!(
                "{component} is not observed: the measurements of {names} do not determine its scale; it has no curve"
            )
        }
    })
}
