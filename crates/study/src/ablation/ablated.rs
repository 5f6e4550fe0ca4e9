//! A part, with and without it: a row of `ablation.csv`.

use crate::run::Ending;
use crate::spent::Spent;

/// One row of `ablation.csv`: a part, with and without it.
#[derive(Debug, Clone, PartialEq)]
pub struct Ablated {
    /// The part that is left out.
    pub part: String,
    /// The scene or fit.
    pub scene: String,
    /// True if a fit includes the part by default.
    pub by_default: bool,
    /// Cost with the part.
    pub with: Spent,
    /// Cost without the part.
    pub without: Spent,
    /// Error from leaving it out: largest change of a force, over the largest force.
    pub error_force: Option<f64>,
    /// Root mean square change of the nodal positions, mm.
    pub error_position_mm: Option<f64>,
    /// Root mean square change of a curve over its range, over the largest stress there.
    pub error_curve: Option<f64>,
    /// Ending of the runs with and without the part.
    pub ending: [Ending; 2],
}

impl Ablated {
    /// Share of the time saved by leaving the part out; negative if this takes longer.
    pub fn saving(&self) -> f64 {
        1.0 - self.without.seconds / self.with.seconds.max(f64::MIN_POSITIVE)
    }

    /// Larger of the relative errors of forces and curve from leaving the part out.
    pub fn relative_error(&self) -> Option<f64> {
        self.error_force.into_iter().chain(self.error_curve).reduce(f64::max)
    }
}
