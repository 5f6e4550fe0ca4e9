//! Kinds of test present in a set and required by a command.

use cloth_data::error::Error;
use cloth_data::frame::{Kind, MeasurementSet};
use std::collections::BTreeSet;
use std::path::Path;

/// True if a set has a sequence of any of these kinds.
pub(super) fn has_any(set: &MeasurementSet, kinds: &[Kind]) -> bool {
    set.sequences.iter().any(|sequence| kinds.contains(&sequence.kind))
}

/// The error for a set without a sequence of the required kinds.
pub(super) fn nothing(path: &Path, set: &MeasurementSet, kinds: &[Kind]) -> Error {
    let names =
        |kinds: &mut dyn Iterator<Item = Kind>| kinds.map(|kind| kind.to_string()).collect::<Vec<_>>();
    let present: BTreeSet<Kind> = set.sequences.iter().map(|sequence| sequence.kind).collect();
    let found = match present.is_empty() {
        true => "no sequence".to_string(),
        false => names(&mut present.into_iter()).join(", "),
    };
    let expected = match names(&mut kinds.iter().copied()).join(" or ") {
        kinds if kinds.is_empty() => "a --known file without all curves".into(),
        kinds => format!("a sequence of kind {kinds}"),
    };
    Error::input(path, None, "kind", found, expected)
}
