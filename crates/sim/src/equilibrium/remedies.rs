//! Numerical interventions of a solve. Each is counted and reported; none changes the criterion for equilibrium.

use serde::{Deserialize, Serialize};
use std::ops::{AddAssign, Sub};

/// Counts of the numerical interventions in one or several solves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Remedies {
    /// Clamped matrices: not positive definite, geometric part clamped element by element.
    pub clamped: usize,
    /// Damped matrices: not positive definite, or shortly after one that was not, with μI added.
    pub damped: usize,
    /// Minimisations that Newton's method could not finish and Levenberg–Marquardt continued.
    pub levenberg_marquardt: usize,
    /// Unstable equilibria left for a lower state beside them.
    pub escapes: usize,
    /// Failed solves restarted with a softer or stiffer membrane.
    pub continued: usize,
    /// Time steps restarted with the energy falling in every iteration.
    pub careful: usize,
    /// Load steps that were too long and were halved.
    pub halved: usize,
}

impl Remedies {
    /// True if no intervention was needed.
    pub fn none(&self) -> bool {
        *self == Self::default()
    }

    /// Combines two counts field by field.
    fn by_fields(self, other: Self, rule: impl Fn(usize, usize) -> usize) -> Self {
        Self {
            clamped: rule(self.clamped, other.clamped),
            damped: rule(self.damped, other.damped),
            levenberg_marquardt: rule(self.levenberg_marquardt, other.levenberg_marquardt),
            escapes: rule(self.escapes, other.escapes),
            continued: rule(self.continued, other.continued),
            careful: rule(self.careful, other.careful),
            halved: rule(self.halved, other.halved),
        }
    }
}

impl AddAssign for Remedies {
    fn add_assign(&mut self, other: Self) {
        *self = self.by_fields(other, |a, b| a + b);
    }
}

impl Sub for Remedies {
    type Output = Self;

    fn sub(self, earlier: Self) -> Self {
        self.by_fields(earlier, |a, b| a - b)
    }
}
