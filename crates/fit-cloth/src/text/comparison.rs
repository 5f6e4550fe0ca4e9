//! Models and variants side by side.

use super::{list, percent};
use crate::page::Ranking;
use cloth_fit::compare::{Comparison, Criterion, Distance, Row};
use std::fmt::Write;

/// One row a model and variant, best first, and what the figures are.
pub fn comparison(comparison: &Comparison) -> String {
    let mut text = format!(
        "{:15}  {:16}  {:>10}  {:>8} {:>9} {:>9}  {:>10} {:>9} {:>9}  {:>16}  {:>10}  {:>14}  {:>7}\n",
        "model",
        "variant",
        "parameters",
        "fit",
        "[N]",
        "[mm]",
        "validation",
        "[N]",
        "[mm]",
        "left out",
        "equilibria",
        "factorisations",
        "seconds"
    );
    for row in &comparison.rows {
        let _ = writeln!(text, "{:15}  {:16}  {}", row.model, row.variant, figures(row));
    }
    let _ = write!(text, "\n{}\n", ranked_by(comparison.ranked_by));
    text + &losses(comparison)
}

/// The same for a page: rows in cells.
pub fn ranking(comparison: &Comparison) -> Ranking {
    let columns = [
        "model",
        "variant",
        "parameters",
        "fit",
        "[N]",
        "[mm]",
        "validation",
        "[N]",
        "[mm]",
        "left out",
        "factorisations",
        "seconds",
        "",
    ];
    let row = |row: &Row| {
        let mut cells = vec![row.model.to_string(), row.variant.to_string()];
        if let Some(failure) = &row.failure {
            cells.push(format!("not fitted: {failure}"));
            return cells;
        }
        let state = if row.converged { "" } else { "NOT converged" };
        let measured = |distance: Option<Distance>| {
            [vec![percent(distance.and_then(|distance| distance.relative))], in_units(distance).into()]
                .concat()
        };
        cells.push(row.parameters.to_string());
        cells.extend(measured(Some(row.fit)));
        cells.extend(measured(row.validation));
        cells.extend([
            left_out(row),
            row.factorisations.to_string(),
            format!("{:.1}", row.seconds),
            state.into(),
        ]);
        cells
    };
    Ranking {
        by: ranked_by(comparison.ranked_by),
        notes: losses(comparison).lines().map(|loss| format!("{loss}.")).collect(),
        columns: columns.map(String::from).into(),
        rows: comparison.rows.iter().map(row).collect(),
    }
}

fn figures(row: &Row) -> String {
    if let Some(failure) = &row.failure {
        return format!("not fitted: {failure}");
    }
    let [fit_n, fit_mm] = in_units(Some(row.fit));
    let [validation_n, validation_mm] = in_units(row.validation);
    format!(
        "{:10}  {:>8} {fit_n:>9} {fit_mm:>9}  {:>10} {validation_n:>9} {validation_mm:>9}  {:>16}  {:10}  {:14}  {:7.1}{}",
        row.parameters,
        percent(row.fit.relative),
        percent(row.validation.and_then(|validation| validation.relative)),
        left_out(row),
        row.equilibria,
        row.factorisations,
        row.seconds,
        if row.converged { "" } else { "  NOT converged" }
    )
}

/// Newtons and millimetres.
fn in_units(distance: Option<Distance>) -> [String; 2] {
    let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.3e}"));
    let force = distance.and_then(|distance| distance.rms_force_n);
    let position = distance.and_then(|distance| Some(1e3 * distance.rms_position_m?));
    [force, position].map(number)
}

/// The overall figure, and how many sequences could not be spared or not be predicted.
fn left_out(row: &Row) -> String {
    let lost = row.left_out.iter().filter(|left| left.distance.is_none()).count();
    match lost {
        0 => percent(row.leave_one_out),
        _ => format!("{} ({lost} lost)", percent(row.leave_one_out)),
    }
}

fn ranked_by(criterion: Criterion) -> String {
    let by = match criterion {
        Criterion::Validation => "the sequences left for validation, which no fit saw",
        Criterion::LeaveOneOut => "the sequences left out of the fit one at a time",
        Criterion::Fit => "the fitted sequences, where more parameters always do better",
    };
    format!(
        "Ranked by the residual on {by}.\nPercentages: residual over the largest measured force (without forces: over the largest travel), root mean square over sequences."
    )
}

/// Components without a curve, and sequences that could not be spared, with the models that this concerns.
fn losses(comparison: &Comparison) -> String {
    let fitted: Vec<&Row> = comparison.rows.iter().filter(|row| row.failure.is_none()).collect();
    let mut said: Vec<(String, Vec<String>)> = Vec::new();
    for row in &fitted {
        for loss in losses_of(row) {
            let name = format!("{} {}", row.model, row.variant);
            match said.iter_mut().find(|(known, _)| *known == loss) {
                Some((_, names)) => names.push(name),
                None => said.push((loss, vec![name])),
            }
        }
    }
    let line = |(loss, names): &(String, Vec<String>)| match names.len() == fitted.len() {
        true => format!("{loss}\n"),
        false => format!("{loss} ({})\n", list(names)),
    };
    said.iter().map(line).collect()
}

fn losses_of(row: &Row) -> Vec<String> {
    let lost = row.left_out.iter().filter(|left| !left.lost.is_empty());
    let lost = lost.map(|left| format!("Without {} nothing shows {}", left.sequence, list(&left.lost)));
    let missing = (!row.missing.is_empty()).then(|| format!("Not observed: {}", list(&row.missing)));
    let failed = row.left_out.iter().filter_map(|left| {
        Some(format!("Without {}, no prediction: {}", left.sequence, left.failure.as_ref()?))
    });
    missing.into_iter().chain(lost).chain(failed).collect()
}
