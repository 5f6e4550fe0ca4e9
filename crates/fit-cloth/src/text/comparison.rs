//! A comparison of models and variants.

use super::list::list;
use super::number::percent;
use cloth_fit::judge::compare::{Comparison, Criterion, Distance, Row};
use serde::{Deserialize, Serialize};

/// Columns and their widths on a terminal; text is left-aligned, numbers right-aligned.
const COLUMNS: [(&str, usize); 14] = [
    ("model", 15),
    ("variant", 16),
    ("parameters", 10),
    ("fit", 8),
    ("[N]", 9),
    ("[mm]", 9),
    ("validation", 10),
    ("[N]", 9),
    ("[mm]", 9),
    ("left out", 16),
    ("equilibria", 10),
    ("factorisations", 14),
    ("seconds", 7),
    ("", 0),
];

/// A comparison as sentences and table cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ranking {
    /// The ranking criterion, as a sentence.
    pub by: String,
    /// Missing curves and predictions, which the rows do not show.
    pub notes: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Best first.
    pub rows: Vec<Vec<String>>,
}

/// One row per model and variant, best first, then the ranking criterion and missing curves.
pub fn comparison(comparison: &Comparison) -> String {
    let names = COLUMNS.map(|(name, _)| name.to_string());
    let rows = comparison.rows.iter().map(cells);
    let lines: String = [names.into()].into_iter().chain(rows).map(|cells| line(&cells) + "\n").collect();
    format!("{lines}\n{}\n{}", ranked_by(comparison.ranked_by), losses(comparison))
}

/// Table cells, for the page.
pub fn ranking(comparison: &Comparison) -> Ranking {
    Ranking {
        by: ranked_by(comparison.ranked_by),
        notes: losses(comparison).lines().map(|loss| format!("{loss}.")).collect(),
        columns: COLUMNS.map(|(name, _)| name.to_string()).into(),
        rows: comparison.rows.iter().map(cells).collect(),
    }
}

/// Pads a row's cells to the column widths.
fn line(cells: &[String]) -> String {
    let cell = |(index, (cell, (name, width))): (usize, (&String, (&str, usize)))| match index {
        0 => format!("{cell:width$}"),
        1 => format!("  {cell:width$}"),
        // The columns in N and mm belong to the percentage before them: less space between.
        _ if name.starts_with('[') => format!(" {cell:>width$}"),
        _ => format!("  {cell:>width$}"),
    };
    let line: String = cells.iter().zip(COLUMNS).enumerate().map(cell).collect();
    line.trim_end().to_string()
}

fn cells(row: &Row) -> Vec<String> {
    let names = [row.model.to_string(), row.variant.to_string()];
    if let Some(failure) = &row.failure {
        return [&names[..], &[format!("not fitted: {failure}")]].concat();
    }
    let told = |distance: Option<Distance>| {
        let [newtons, millimetres] = in_units(distance);
        [percent(distance.and_then(|distance| distance.relative)), newtons, millimetres]
    };
    let spent = [row.equilibria.to_string(), row.factorisations.to_string(), format!("{:.1}", row.seconds)];
    let state = if row.converged { "" } else { "NOT converged" };
    [
        &names[..],
        &[row.parameters.to_string()],
        &told(Some(row.fit)),
        &told(row.validation),
        &[left_out(row)],
        &spent,
        &[state.into()],
    ]
    .concat()
}

/// Rms force in N and rms position in mm.
fn in_units(distance: Option<Distance>) -> [String; 2] {
    let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.3e}"));
    let force = distance.and_then(|distance| distance.rms_force_n);
    let position = distance.and_then(|distance| Some(1e3 * distance.rms_position_m?));
    [force, position].map(number)
}

/// The leave-one-out residual, and the number of sequences that could not be left out or predicted.
fn left_out(row: &Row) -> String {
    let lost = row.left_out.iter().filter(|left| left.distance.is_none()).count();
    match lost {
        0 => percent(row.leave_one_out),
        _ => format!("{} ({lost} lost)", percent(row.leave_one_out)),
    }
}

fn ranked_by(criterion: Criterion) -> String {
    let by = match criterion {
        Criterion::Validation => "the validation sequences, which no fit used",
        Criterion::LeaveOneOut => "the sequences left out of the fit one at a time",
        Criterion::Fit => "the fitted sequences, where more parameters always do better",
    };
    format!(
        "Ranked by the residual on {by}.\nPercentages: residual over the largest measured force (without forces: over the largest travel), root mean square over sequences."
    )
}

/// Components without a curve and sequences that could not be left out, with the models concerned.
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
    let lost =
        lost.map(|left| format!("Without {}, no sequence observes {}", left.sequence, list(&left.lost)));
    let missing = (!row.missing.is_empty()).then(|| format!("Not observed: {}", list(&row.missing)));
    let failed = row.left_out.iter().filter_map(|left| {
        Some(format!("Without {}, no prediction: {}", left.sequence, left.failure.as_ref()?))
    });
    missing.into_iter().chain(lost).chain(failed).collect()
}
