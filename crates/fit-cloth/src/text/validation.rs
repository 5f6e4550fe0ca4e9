//! Validation: curves against tests that their fit did not use.

use super::interventions::interventions;
use super::list::list;
use super::number::{cell, percent};
use cloth_data::frame::MeasurementSet;
use cloth_fit::judge::validation::{Validated, Validation};
use cloth_fit::material::file::{CurveEntry, MaterialFile};
use cloth_sim::material::Component;
use std::collections::BTreeSet;
use std::fmt::Write;

/// One row per sequence, frames with several equilibria, and a verdict.
pub fn validation(set: &MeasurementSet, material: &MaterialFile, validation: &Validation) -> String {
    let (of, on) = (&material.fabric.name, &set.fabric.name);
    let mut text = format!("curves of {of} ({}) on tests of {on}\n", material.model);
    let assumed = &validation.prediction.assumed;
    if !assumed.is_empty() {
        let _ = writeln!(text, "assumed constant, since not known: {}", list(assumed));
    }
    let _ = write!(text, "\n{}", table(validation));
    for Validated { report, .. } in &validation.sequences {
        if !report.multi_stable.is_empty() {
            let frames = list(&report.multi_stable);
            let _ = writeln!(text, "\nSeveral equilibria in {}: frames {frames}", report.name);
        }
    }
    let helped = interventions(&validation.prediction.interventions);
    format!("{text}\n{helped}{}\n", verdict(material, validation))
}

/// A warning if curves for one grid are simulated on another one: bending springs, whose moments depend on it, and curves
/// that make up for its error.
///
/// * `nodes` — a grid was asked for
pub fn other_grid(material: &MaterialFile, validation: &Validation, nodes: bool) -> Option<String> {
    if let Some(side) = material.provenance.for_mesh_m {
        let side = 1e3 * side;
        return nodes.then(|| {
            format!("these curves hold only on cells of {side} mm, their default here, without --nodes")
        });
    }
    let bends = |(component, entry): (&Component, &CurveEntry)| component.is_bending() && entry.observed;
    let of_springs = material.model.is_of_springs() && material.curves.iter().any(bends);
    let curves = match of_springs {
        true => "bending curves of springs",
        false if material.provenance.as_published => "curves fitted as published",
        false => return None,
    };
    let fitted: BTreeSet<[usize; 2]> = material.provenance.nodes.values().copied().collect();
    let reports = validation.sequences.iter().map(|sequence| &sequence.report);
    let others: Vec<&str> = reports
        .filter(|report| !report.planar && !fitted.contains(&report.nodes))
        .map(|report| &report.name[..])
        .collect();
    let size = |[columns, rows]: &[usize; 2]| format!("{columns}x{rows}");
    (!others.is_empty() && !fitted.is_empty()).then(|| {
        format!(
            "{curves} hold only on the grid of their fit, {}; simulate {} on it with --nodes",
            list(fitted.iter().map(size)),
            list(&others)
        )
    })
}

fn table(validation: &Validation) -> String {
    let lost = validation.lost();
    let names =
        validation.sequences.iter().map(|s| &s.report.name[..]).chain(lost.iter().map(|(name, _)| *name));
    let width = names.map(|name| name.chars().count()).max().unwrap_or(0).max(8);
    let mut text = format!(
        "{:width$}  frames  left out  several equilibria  rms force [N]  of largest  rms position [mm]  {:27}  {:>14}  {:>12}\n",
        "sequence", "measure", "rms difference", "of its range"
    );
    for sequence in &validation.sequences {
        let report = &sequence.report;
        let of_largest = report.force_rms.map(|rms| rms / report.force_largest.max(f64::MIN_POSITIVE));
        let measure = sequence.measure.as_ref().map(|(measure, _)| *measure);
        let rms =
            measure.zip(sequence.measure_rms()).map(|(measure, rms)| format!("{rms:.3e} {}", measure.unit()));
        let _ = writeln!(
            text,
            "{:width$}  {:6}  {:8}  {:18}  {:>13}  {:>10}  {:>17}  {:27}  {:>14}  {:>12}",
            report.name,
            report.frames,
            validation.left_out(report),
            report.multi_stable.len(),
            cell(report.force_rms, 5),
            percent(of_largest),
            cell(report.position_rms.map(|rms| 1e3 * rms), 4),
            measure.map_or("-".into(), |measure| measure.to_string()),
            rms.unwrap_or("-".into()),
            percent(sequence.measure_share()),
        );
    }
    for (name, frames) in lost {
        let _ = writeln!(text, "{name:width$}  {:6}  {frames:8}  no frame has an equilibrium", 0);
    }
    text
}

/// The result in one sentence.
fn verdict(material: &MaterialFile, validation: &Validation) -> String {
    let met = list(validation.sequences.iter().filter_map(meets));
    let lost: Vec<&str> = validation.lost().into_iter().map(|(name, _)| name).collect();
    let mut text = format!("Rms: the curves of {}", material.fabric.name);
    let _ = match met.is_empty() {
        true => write!(text, " have no measurement to compare with"),
        false => write!(text, " reproduce {met}"),
    };
    if validation.sequences.iter().any(|sequence| !sequence.report.multi_stable.is_empty()) {
        let _ = write!(text, "; positions of frames with several equilibria are not counted");
    }
    if !lost.is_empty() {
        let _ = write!(text, "; no equilibrium to compare with in {}", list(lost));
    }
    text + "."
}

/// The residual of a sequence's measure, else of its forces, else of its shapes.
fn meets(sequence: &Validated) -> Option<String> {
    let report = &sequence.report;
    let name = &report.name;
    if let Some(((measure, _), share)) = sequence.measure.as_ref().zip(sequence.measure_share()) {
        return Some(format!("the {measure} of {name} within {} of its range", percent(Some(share))));
    }
    if let Some(rms) = report.force_rms.filter(|_| report.force_largest > 0.0) {
        let share = percent(Some(rms / report.force_largest));
        return Some(format!("the forces of {name} within {share} of the largest"));
    }
    report.position_rms.map(|rms| format!("the shapes of {name} within {:.3} mm", 1e3 * rms))
}
