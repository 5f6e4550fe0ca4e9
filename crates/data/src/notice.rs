//! Notices about a measurement: a contradiction, or a correction.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Severity of a notice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// For information; the curve is unaffected.
    Remark,
    /// The sequence is fitted, but the error of its curves may exceed their bands.
    Doubt,
    /// The sequence contradicts itself and is not fitted.
    Refusal,
}

/// A contradiction within a sequence, or a correction made to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Notice {
    /// Severity.
    pub severity: Severity,
    /// Name of the sequence.
    pub sequence: String,
    /// File in the sequence folder with field, row or frame, e.g. `test.toml gravity_m_s2`.
    pub place: String,
    /// The contradiction, with its values.
    pub found: String,
    /// The value expected, with a remedy.
    pub expected: String,
    /// Changes of which any one would settle it, where they can be stated as numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remedies: Vec<Remedy>,
}

/// A change of an import or a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Remedy {
    /// Reading of the load cell without load, N, to be subtracted from every force.
    Zero(f64),
    /// Free length of a strip, m, instead of its gauge length.
    FreeLength(f64),
    /// A fit in which outliers count less.
    Robust,
}

impl Notice {
    /// A notice for information.
    pub fn remark(
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Remark, sequence, place, found, expected)
    }

    /// A doubt: the error of the curves may exceed their bands.
    pub fn doubt(
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Doubt, sequence, place, found, expected)
    }

    /// A refusal: the sequence is not fitted.
    pub fn refusal(
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Refusal, sequence, place, found, expected)
    }

    /// Adds remedies.
    pub fn with(self, remedies: Vec<Remedy>) -> Self {
        Self { remedies, ..self }
    }

    /// A notice of the given severity.
    pub fn new(
        severity: Severity,
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            severity,
            sequence: sequence.into(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
            remedies: Vec::new(),
        }
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sequence, place, found, expected, .. } = self;
        write!(f, "sequence {sequence}, {place}: found {found}, expected {expected}")
    }
}
