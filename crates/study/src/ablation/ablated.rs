//! A part, with and without it: a row of `ablation.csv`.

use crate::run::Ending;
use crate::spent::Spent;

/// One row of `ablation.csv`: a part, with and without it.
#[derive(Debug, Clone, PartialEq)]
pub struct Ablated {
    /// What is left out.
    pub part: String,
    /// Where.
    pub scene: String,
    /// A fit has it by default.
    pub by_default: bool,
    /// Cost with it.
    pub with: Spent,
    /// Cost without it.
    pub without: Spent,
    /// What leaving it out changes: largest change of a force, over the largest force.
    pub error_force: Option<f64>,
    /// Root mean square change of the nodes' places, mm.
    pub error_position_mm: Option<f64>,
    /// Root mean square change of a curve over its range, over the largest stress there.
    pub error_curve: Option<f64>,
    /// How the runs ended, with and without.
    pub ending: [Ending; 2],
}

impl Ablated {
    /// Share of the time that leaving it out saves; below zero if that costs time.
    pub fn saving(&self) -> f64 {
        1.0 - self.without.seconds / self.with.seconds.max(f64::MIN_POSITIVE)
    }

    /// The largest relative error that it causes to leave it out: of forces or of a curve.
    pub fn relative_error(&self) -> Option<f64> {
        self.error_force.into_iter().chain(self.error_curve).reduce(f64::max)
    }
}
