//! Detects contradictions within a measured set before any simulation.
//!
//! ```text
//! set ──▶ checks of each sequence ──▶ the set to fit: without refused sequences, lost points marked as unobserved
//!                                └──▶ notices: shown on the terminal and the page, and stored in material.json
//! ```
//!
//! Each check compares two measured quantities that describe the same thing: weight and the sag of a sheet, clip
//! poses and observed vertices, the force at the gauge length and the rest state.

mod edge;
mod failed_points;
mod grip;
mod noise;
mod poses;
mod profile;
pub(crate) mod pull;
mod sag;
mod shapes;
mod size;
mod tare;
mod weight;
mod yarns;

use crate::error::{Error, Result};
use crate::frame::{Fabric, Kind, MeasurementSet, Sequence};
use crate::notice::{Notice, Severity};

/// An inspected set, ready to fit, and its notices.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// The set without the refused sequences.
    pub set: MeasurementSet,
    /// All notices, sequence by sequence.
    pub notices: Vec<Notice>,
    /// Names and kinds of the refused sequences.
    refused: Vec<(String, Kind)>,
}

impl Inspection {
    /// Reports a refused sequence of one of the given kinds.
    ///
    /// # Errors
    /// The contradiction of that sequence.
    pub fn check_refusals(&self, kinds: &[Kind]) -> Result<()> {
        let of_kind = |notice: &&Notice| {
            let refused = |(name, kind): &(String, Kind)| *name == notice.sequence && kinds.contains(kind);
            notice.severity == Severity::Refusal && self.refused.iter().any(refused)
        };
        self.notices
            .iter()
            .find(of_kind)
            .map_or(Ok(()), |notice| Err(Error::Contradiction(Box::new(notice.clone()))))
    }
}

/// Checks one sequence, adds a notice for each contradiction, and marks points without a valid observation as
/// unobserved (NaN).
type Check = fn(&Fabric, &mut Sequence, &mut Vec<Notice>);

/// All checks in the order in which they run. The first check that refuses a sequence ends its inspection.
const CHECKS: [Check; 14] = [
    noise::check,
    shapes::check_presence,
    size::check,
    failed_points::check,
    shapes::check_heights,
    poses::check,
    grip::check,
    weight::check,
    sag::check,
    yarns::check,
    edge::check,
    sag::check_frames,
    tare::check,
    pull::check,
];

/// Runs all checks on all sequences of a set.
pub fn inspect(set: &MeasurementSet) -> Inspection {
    let fabric = &set.fabric;
    let mut inspection = Inspection {
        set: MeasurementSet { fabric: fabric.clone(), sequences: Vec::new() },
        notices: Vec::new(),
        refused: Vec::new(),
    };
    for sequence in &set.sequences {
        let (sequence, notices) = inspect_sequence(fabric, sequence);
        match notices.iter().any(|notice| notice.severity == Severity::Refusal) {
            true => inspection.refused.push((sequence.name.clone(), sequence.kind)),
            false => inspection.set.sequences.push(sequence),
        }
        inspection.notices.extend(notices);
    }
    weight::doubt_others(&inspection.set, &mut inspection.notices);
    inspection
}

/// Runs all checks on one sequence.
pub fn inspect_sequence(fabric: &Fabric, sequence: &Sequence) -> (Sequence, Vec<Notice>) {
    let (mut sequence, mut notices) = (sequence.clone(), Vec::new());
    for check in CHECKS {
        check(fabric, &mut sequence, &mut notices);
        if notices.iter().any(|notice: &Notice| notice.severity == Severity::Refusal) {
            break;
        }
    }
    (sequence, notices)
}

#[cfg(test)]
mod tests;
