//! What a solve did beside plain Newton steps, counted: nothing is mended in silence. None of it changes what counts as
//! balanced.

use serde::{Deserialize, Serialize};
use std::ops::{AddAssign, Sub};

/// How often a solve, or several, helped themselves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Remedies {
    /// Matrices that were not positive definite, and whose geometric part was clamped element by element.
    pub clamped: usize,
    /// Matrices that were not positive definite, or had not been shortly before, and to which μI was added.
    pub damped: usize,
    /// Minimisations that Newton's method could not finish and Levenberg–Marquardt went on with.
    pub levenberg_marquardt: usize,
    /// Balances that were not stable, and were left for a lower one beside them.
    pub escapes: usize,
    /// Solves that came to nothing, and were begun anew with a softer or stiffer membrane.
    pub continued: usize,
    /// Time steps that were begun anew, downhill all the way.
    pub careful: usize,
    /// Load steps that were too long, and were halved.
    pub halved: usize,
}

impl Remedies {
    /// True if nothing was needed.
    pub fn none(&self) -> bool {
        *self == Self::default()
    }

    /// The same figures by two rules, field by field.
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
