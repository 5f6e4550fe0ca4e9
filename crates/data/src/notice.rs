//! What was noticed of a measurement: a contradiction, or what was done about one.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How much a notice matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Worth knowing; the curve is as good as without it.
    Remark,
    /// The sequence is fitted, but its curves may be wrong by more than their bands.
    Doubt,
    /// The sequence contradicts itself and takes no part.
    Refusal,
}

/// A contradiction within a sequence, or something that was done about one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Notice {
    /// How much it matters.
    pub severity: Severity,
    /// Name of the sequence.
    pub sequence: String,
    /// File of the sequence's folder, with the field, row or frame, as `test.toml gravity_m_s2`.
    pub place: String,
    /// The contradiction, with its figures.
    pub found: String,
    /// What was expected, and what to do.
    pub expected: String,
}

impl Notice {
    /// Worth knowing.
    pub fn remark(
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Remark, sequence, place, found, expected)
    }

    /// The sequence's curves may be wrong by more than their bands.
    pub fn doubt(
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Doubt, sequence, place, found, expected)
    }

    /// The sequence takes no part.
    pub fn refusal(
        sequence: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::new(Severity::Refusal, sequence, place, found, expected)
    }

    /// With its severity.
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
        }
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sequence, place, found, expected, .. } = self;
        write!(f, "sequence {sequence}, {place}: found {found}, expected {expected}")
    }
}
