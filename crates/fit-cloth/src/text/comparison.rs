//! Models and variants side by side.

use super::list::list;
use super::number::percent;
use cloth_fit::judge::compare::{Comparison, Criterion, Distance, Row};
use serde::{Deserialize, Serialize};

/// What stands in a row, and how wide on a terminal; text on the left, numbers on the right.
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

/// A comparison in words and cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ranking {
    /// What ranks, in words.
    pub by: String,
    /// What no row tells: curves and predictions that are missing.
    pub notes: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Best first.
    pub rows: Vec<Vec<String>>,
}

/// One row a model and variant, best first, and what the figures are.
pub fn comparison(comparison: &Comparison) -> String {
    let names = COLUMNS.map(|(name, _)| name.to_string());
    let rows = comparison.rows.iter().map(cells);
    let lines: String = [names.into()].into_iter().chain(rows).map(|cells| line(&cells) + "\n").collect();
    format!("{lines}\n{}\n{}", ranked_by(comparison.ranked_by), losses(comparison))
}

/// The same in cells.
pub fn ranking(comparison: &Comparison) -> Ranking {
    Ranking {
        by: ranked_by(comparison.ranked_by),
        notes: losses(comparison).lines().map(|loss| format!("{loss}.")).collect(),
        columns: COLUMNS.map(|(name, _)| name.to_string()).into(),
        rows: comparison.rows.iter().map(cells).collect(),
    }
}

/// Cells below one another.
fn line(cells: &[String]) -> String {
    let cell = |(index, (cell, (name, width))): (usize, (&String, (&str, usize)))| match index {
        0 => format!("{cell:width$}"),
        1 => format!("  {cell:width$}"),
        // In newtons and millimetres is said what is said before.
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
