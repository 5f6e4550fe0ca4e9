//! The table of the stability suite: conditions, runs and results.

use std::fmt;

/// Extent of a run of the suite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// Takes seconds; part of every test run.
    Quick,
    /// Complete; takes minutes.
    Full,
}

impl Extent {
    /// Number of runs.
    pub(crate) fn runs(self, quick: u32, full: u32) -> u32 {
        match self {
            Self::Quick => quick,
            Self::Full => full,
        }
    }
}

/// One case under one condition, over a range of inputs.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    /// Number in the list of docs/stability.md.
    pub(crate) case: u8,
    /// Condition: model, scene, stiffness ratio, …
    pub(crate) condition: String,
    /// Measured quantity: `imbalance`, `relative error`, …; empty if a run only holds or does not.
    pub(crate) measure: &'static str,
    /// Limit of the measure.
    pub(crate) limit: f64,
    /// Worst measure of all runs; 0 before the first.
    pub(crate) worst: f64,
    /// Number of inputs tried.
    pub(crate) runs: u64,
    /// Number of runs that passed.
    pub(crate) survived: u64,
    /// Equilibria with a tolerance set by rounding.
    pub(crate) by_rounding: u64,
    /// Largest number of iterations of a run; 0 if nothing iterates.
    pub(crate) iterations: usize,
    /// The first failure.
    pub(crate) failure: Option<String>,
}

impl Row {
    /// A row whose runs hold or do not.
    pub(crate) fn new(case: u8, condition: impl Into<String>) -> Self {
        Self::measured(case, condition, "", 0.0)
    }

    /// A row whose runs are measured against a limit.
    pub(crate) fn measured(
        case: u8,
        condition: impl Into<String>,
        measure: &'static str,
        limit: f64,
    ) -> Self {
        Self {
            case,
            condition: condition.into(),
            measure,
            limit,
            worst: 0.0,
            runs: 0,
            survived: 0,
            by_rounding: 0,
            iterations: 0,
            failure: None,
        }
    }

    /// Adds a run, which survives if it holds.
    pub(crate) fn holds(&mut self, holds: bool, failure: impl FnOnce() -> String) -> bool {
        self.runs += 1;
        self.survived += u64::from(holds);
        if !holds {
            self.failure.get_or_insert_with(failure);
        }
        holds
    }

    /// Adds a run with its measure, which survives if that is within the limit; NaN is not.
    pub(crate) fn measure(&mut self, measure: f64, input: impl FnOnce() -> String) -> bool {
        if measure.is_nan() || measure > self.worst {
            self.worst = measure;
        }
        let (what, limit) = (self.measure, self.limit);
        self.holds(measure <= limit, || format!("{what} {measure:.3e} above {limit:.0e}: {}", input()))
    }

    /// True if there was at least one run and all survived.
    pub(crate) fn is_green(&self) -> bool {
        self.runs > 0 && self.survived == self.runs
    }
}

/// Formats a row of the table in docs/stability.md.
impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |count: u64| if count == 0 { String::new() } else { count.to_string() };
        let worst = match self.measure {
            "" => String::new(),
            // A share of a tolerance: with more digits, so that a value within it is not rounded up to it.
            measure if self.limit == 1.0 => format!("{measure} {:.3} of 1", self.worst),
            measure => format!("{measure} {:.1e} of {:.0e}", self.worst, self.limit),
        };
        write!(
            f,
            "| {} | {} | {} | {} | {worst} | {} | {} |",
            self.case,
            self.condition,
            self.runs,
            self.survived,
            number(self.iterations as u64),
            number(self.by_rounding),
        )
    }
}

/// The header of the table.
pub(crate) const HEADER: &str = "\
| case | condition | runs | survived | worst, of what is allowed | most iterations | decided by rounding |
|---|---|---|---|---|---|---|";

/// The header of [`summary`].
pub(crate) const SUMMARY: &str = "\
| case | | conditions | runs | survived | nearest to what is allowed | most iterations | decided by rounding |
|---|---|---|---|---|---|---|---|";

/// All conditions of a case in one row, with the measure nearest to its limit.
///
/// * `name` — name of the test, such as `case_22_stiff_against_soft`
pub(crate) fn summary(name: &str, rows: &[Row]) -> String {
    let sum = |figure: fn(&Row) -> u64| rows.iter().map(figure).sum::<u64>();
    let [_, number, title] = std::array::from_fn(|part| name.splitn(3, '_').nth(part).unwrap_or_default());
    let share = |row: &Row| row.worst / row.limit;
    let measured = rows.iter().filter(|row| !row.measure.is_empty() && row.limit > 0.0);
    let nearest = measured.max_by(|a, b| share(a).total_cmp(&share(b)));
    let nearest = nearest.map(|row| format!("{} {:.1e} of {:.0e}", row.measure, row.worst, row.limit));
    let iterations = rows.iter().map(|row| row.iterations).max().unwrap_or_default();
    format!(
        "| {} | {} | {} | {} | {} | {} | {} | {} |",
        number.trim_start_matches('0'),
        title.replace('_', " "),
        rows.len(),
        sum(|row| row.runs),
        sum(|row| row.survived),
        nearest.unwrap_or_default(),
        iterations,
        sum(|row| row.by_rounding)
    )
}

/// Panics with the first failure of every row that is not green.
///
/// # Panics
/// If a row is not green, or there is no row.
pub(crate) fn assert_green(rows: &[Row]) {
    assert!(!rows.is_empty(), "no row");
    let red = rows.iter().filter(|row| !row.is_green());
    let complaints: Vec<String> =
        red.map(|row| format!("{row}\n  {}", row.failure.as_deref().unwrap_or("never run"))).collect();
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
