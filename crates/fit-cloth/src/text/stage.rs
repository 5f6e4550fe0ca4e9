//! One stage: its basis, its course, its curve.

use super::band::NO_KNOWLEDGE;
use super::interventions::interventions;
use super::list::list;
use super::range::seen;
use super::unit::unit;
use cloth_fit::equilibria::Objective;
use cloth_fit::stage::report::StageReport;
use cloth_sim::strain_measure::StrainMeasure;
use std::fmt::Write;

/// Basis and course of a stage, line by line, without the run time, which differs between runs.
pub fn course(stage: &StageReport) -> Vec<String> {
    let words =
        [basis(stage), levels(stage), counted(stage, ""), interventions(&stage.interventions)].concat();
    words.lines().skip(1).map(|line| line.trim().into()).collect()
}

/// A stage of the fit, with all iterations if `verbose`.
pub fn stage(stage: &StageReport, verbose: bool) -> String {
    let growth = if verbose { iterations(stage) } else { levels(stage) };
    let helped = interventions(&stage.interventions);
    [basis(stage), growth, spent(stage), helped, curve(stage)].concat()
}

/// The sequences fitted to and the curves taken as known.
fn basis(stage: &StageReport) -> String {
    let pass = if stage.pass > 1 { ", second pass" } else { "" };
    let compared = match stage.objective {
        Objective::Forces => "clip forces",
        Objective::Positions => "shapes",
    };
    let sequences = list(stage.sequences.iter().map(|s| format!("{} ({} frames)", s.name, s.frames)));
    let mut text =
        format!("{}, {}{pass}\n  fitted to the {compared} of {sequences}\n", stage.name(), stage.model);
    let basis = &stage.basis;
    if !basis.known.is_empty() {
        let exact = basis.known.iter().filter(|component| !basis.carried.contains(component));
        let _ = write!(text, "  known: {}", list(&basis.known));
        let exact = list(exact);
        let _ = match exact.is_empty() {
            true => writeln!(text, " (the band includes their errors)"),
            false => writeln!(text, " (taken as exact: {exact})"),
        };
    }
    if !basis.assumed.is_empty() {
        let _ = writeln!(text, "  assumed constant, since not known: {}", list(&basis.assumed));
    }
    text
}

/// The residual for every number of control points.
fn levels(stage: &StageReport) -> String {
    let (name, factor) = unit(stage);
    let levels = list(stage.levels.iter().map(|level| {
        let kept = if level.points == stage.curve.curve.len() { " (kept)" } else { "" };
        format!("{}: {:.3e}{kept}", level.points, factor * level.rms)
    }));
    format!("  rms [{name}] by control points: {levels}\n")
}

/// The iterations for every number of control points.
fn iterations(stage: &StageReport) -> String {
    let (name, factor) = unit(stage);
    let rms = format!("rms [{name}]");
    let mut text = format!("  points  iteration  {rms:>9}     gain      step    radius  kept\n");
    for level in &stage.levels {
        if level.iterations.is_empty() {
            let _ = writeln!(text, "  {:6}  {:9}  {:9.3e}", level.points, 0, factor * level.rms);
        }
        for (iteration, rms) in level.iterations.iter().zip(level.course()) {
            let gain = iteration.gain.map_or("-".into(), |gain| format!("{gain:.1e}"));
            let _ = writeln!(
                text,
                "  {:6}  {:9}  {:9.3e}  {gain:>8}  {:8.1e}  {:8.1e}  {}",
                level.points,
                iteration.iteration,
                factor * rms,
                iteration.step,
                iteration.radius,
                if iteration.accepted { "yes" } else { "no" }
            );
        }
    }
    text
}

/// Work and run time.
fn spent(stage: &StageReport) -> String {
    counted(stage, &format!(", {:.2} s", stage.seconds))
}

fn counted(stage: &StageReport, time: &str) -> String {
    let counters = &stage.counters;
    format!(
        "  {} equilibria, {} Newton steps, {} factorisations{time}; {}\n",
        counters.equilibria, counters.iterations, counters.factorisations, stage.growth
    )
}

/// The control points with their uncertainties.
fn curve(stage: &StageReport) -> String {
    let report = &stage.curve;
    if !report.observed {
        return "  NOT observed: a curve twice as stiff would fit the measurements as well\n".into();
    }
    let [strain, stiffness, stress] = match stage.model.strain_measure(stage.components[0]) {
        StrainMeasure::Hinge | StrainMeasure::RingTwo => ["curvature [1/m]", "rigidity [N m]", "moment [N]"],
        measure => [measure.names()[0], "stiffness [N/m]", "stress [N/m]"],
    };
    let mut text = format!(
        "  {strain:<15}  {stiffness:>15}             {stress:>12}   (seen from {}, {:.0} % of the range)\n",
        seen(stage),
        100.0 * report.share_visited
    );
    for (i, point) in report.points.iter().enumerate() {
        let size = report.curve.stiffnesses()[i].abs().max(f64::MIN_POSITIVE);
        let deviation = match report.half_bands[i] {
            Some(half) if half < NO_KNOWLEDGE * size => format!("± {:.1} %", 100.0 * half / size),
            _ => "not known".into(),
        };
        let _ = writeln!(
            text,
            "  {:<15.5}  {:15.5e} {deviation:>10}  {:12.5e}",
            point.strain, point.stiffness, point.stress
        );
    }
    for i in &report.unseen {
        let _ = writeln!(text, "  no frame observes control point {}", i + 1);
    }
    for (i, j, correlation) in report.correlated() {
        let _ = writeln!(text, "  correlated: control points {} and {} ({correlation:.3})", i + 1, j + 1);
    }
    if report.active_constraints > 0 {
        let _ = writeln!(text, "  {} stability constraints are active", report.active_constraints);
    }
    text
}
