//! Contradictions within a measured set, found before anything is simulated.
//!
//! ```text
//! set ──▶ checks of each sequence ──▶ the set that is fitted: without refused sequences, unobserved points left out
//!                                └──▶ notices: said on the terminal, the page and in material.json
//! ```
//!
//! A check compares what two measured quantities say of the same thing: weight against the way a sheet sags, clip poses
//! against the vertices that were seen, forces at the gauge length against rest.

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

/// A set made ready to fit, and what was noticed on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Inspection {
    /// The set without the sequences that were refused.
    pub set: MeasurementSet,
    /// Everything noticed, sequence by sequence.
    pub notices: Vec<Notice>,
    /// The kinds of the refused sequences.
    refused: Vec<(String, Kind)>,
}

impl Inspection {
    /// The refusal of a sequence of one of some kinds, if there is one.
    ///
    /// # Errors
    /// That refusal.
    pub fn check_refusals(&self, kinds: &[Kind]) -> Result<()> {
        let of_kind = |notice: &&Notice| {
            let refused = |(name, kind): &(String, Kind)| *name == notice.sequence && kinds.contains(kind);
            notice.severity == Severity::Refusal && self.refused.iter().any(refused)
        };
        self.notices.iter().find(of_kind).map_or(Ok(()), |notice| Err(Error::Contradiction(notice.clone())))
    }
}

/// Looks for contradictions in one sequence, adds a notice for each, and marks points as unobserved (NaN) that were not
/// seen where the file has them.
type Check = fn(&Fabric, &mut Sequence, &mut Vec<Notice>);

/// All checks, in the order in which they run: the first that refuses a sequence is the last that sees it.
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
