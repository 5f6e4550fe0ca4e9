//! Ranks models and variants.

use super::row::{Criterion, Row};
use super::table;
use cloth_data::io::schema::Schema;
use serde::Serialize;

/// Models and variants, best first.
#[must_use]
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Criterion of the ranking.
    pub ranked_by: Criterion,
    /// One row each.
    pub rows: Vec<Row>,
}

impl Comparison {
    /// Ranks rows. Rows that dropped frames which others kept come after those, since their figure is of an easier
    /// test; rows without the ranking figure come last.
    pub fn new(mut rows: Vec<Row>) -> Self {
        let ranked_by = if rows.iter().any(|row| row.figure(Criterion::Validation).is_some()) {
            Criterion::Validation
        } else if all_spare_the_same(&rows) {
            Criterion::LeaveOneOut
        } else {
            Criterion::Fit
        };
        let figure = |row: &Row| row.figure(ranked_by).unwrap_or(f64::INFINITY);
        let ranked = rows.iter().filter(|row| row.figure(ranked_by).is_some());
        let fewest = ranked.map(|row| row.dropped(ranked_by)).min().unwrap_or(0);
        let easier = |row: &Row| row.figure(ranked_by).is_none() || row.dropped(ranked_by) > fewest;
        rows.sort_by(|a, b| easier(a).cmp(&easier(b)).then(figure(a).total_cmp(&figure(b))));
        Self { ranked_by, rows }
    }

    /// The text of `compare.json`.
    pub fn to_json(&self) -> String {
        // Strings and finite numbers only: serialisation cannot fail.
        let file = File { schema: SCHEMA.id(), ranking: self };
        serde_json::to_string_pretty(&file).map(|text| text + "\n").unwrap_or_default()
    }

    /// The text of `compare.csv`: one row per entry, empty cells where a figure does not exist.
    pub fn to_csv(&self) -> String {
        table::csv(&self.rows)
    }
}

/// The format of `compare.json`.
const SCHEMA: Schema = Schema::new("comparison", &[]);

/// `compare.json`.
#[derive(Serialize)]
struct File<'a> {
    schema: String,
    #[serde(flatten)]
    ranking: &'a Comparison,
}

/// Figures are comparable only if every variant left out the same sequences.
fn all_spare_the_same(rows: &[Row]) -> bool {
    let spared = |row: &Row| -> Vec<String> {
        let predicted = row.left_out.iter().filter(|left| left.relative().is_some());
        predicted.map(|left| left.sequence.clone()).collect()
    };
    let mut fitted = rows.iter().filter(|row| row.failure.is_none()).map(spared);
    fitted.next().is_some_and(|first| !first.is_empty() && fitted.all(|other| other == first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::compare::{Distance, LeftOut};
    use crate::stage::Settings;
    use cloth_data::error::Error;

    fn row(fit: f64, validation: Option<f64>, spared: &[&str]) -> Row {
        let distance = |relative| Distance { relative, ..Distance::default() };
        let left_out = |name: &&str| LeftOut {
            sequence: name.to_string(),
            lost: Vec::new(),
            failure: None,
            distance: Some(distance(Some(fit))),
        };
        Row {
            failure: None,
            fit: distance(Some(fit)),
            validation: validation.map(|figure| distance(Some(figure))),
            left_out: spared.iter().map(left_out).collect(),
            leave_one_out: (!spared.is_empty()).then_some(1.0 - fit),
            ..Row::failed(
                &Settings::default(),
                &Error::Setting { field: "points", found: "0".into(), expected: "more".into() },
            )
        }
    }

    fn ranks(rows: [Row; 2]) -> (Criterion, f64) {
        let comparison = Comparison::new(rows.into());
        (comparison.ranked_by, comparison.rows[0].fit.relative.unwrap())
    }

    #[test]
    fn what_no_fit_saw_ranks_before_what_it_did_see() {
        assert_eq!(ranks([row(0.2, None, &[]), row(0.1, None, &[])]), (Criterion::Fit, 0.1));
        assert_eq!(ranks([row(0.1, Some(0.4), &[]), row(0.2, Some(0.3), &[])]), (Criterion::Validation, 0.2));
        assert_eq!(ranks([row(0.1, None, &[]), row(0.2, Some(0.3), &[])]), (Criterion::Validation, 0.2));
    }

    #[test]
    fn sequences_left_out_rank_where_all_could_spare_the_same() {
        assert_eq!(ranks([row(0.1, None, &["a"]), row(0.2, None, &["a"])]), (Criterion::LeaveOneOut, 0.2));
        assert_eq!(ranks([row(0.1, None, &["a", "b"]), row(0.2, None, &["a"])]), (Criterion::Fit, 0.1));
        assert_eq!(ranks([row(0.1, None, &[]), row(0.2, None, &["a"])]), (Criterion::Fit, 0.1));
    }
}
