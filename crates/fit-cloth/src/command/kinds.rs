//! Which kinds of test a set has, and which a command wants.

use cloth_data::error::Error;
use cloth_data::frame::{Kind, MeasurementSet};
use std::collections::BTreeSet;
use std::path::Path;

/// True if a set has a sequence of one of some kinds.
pub(super) fn has_any(set: &MeasurementSet, kinds: &[Kind]) -> bool {
    set.sequences.iter().any(|sequence| kinds.contains(&sequence.kind))
}

/// No sequence of a set is of the kinds that are wanted.
pub(super) fn nothing(path: &Path, set: &MeasurementSet, kinds: &[Kind]) -> Error {
    let names =
        |kinds: &mut dyn Iterator<Item = Kind>| kinds.map(|kind| kind.to_string()).collect::<Vec<_>>();
    let present: BTreeSet<Kind> = set.sequences.iter().map(|sequence| sequence.kind).collect();
    let found = match present.is_empty() {
        true => "no sequence at all".to_string(),
        false => names(&mut present.into_iter()).join(", "),
    };
    let expected = match names(&mut kinds.iter().copied()).join(" or ") {
        kinds if kinds.is_empty() => "a --known file that lacks a curve".into(),
        kinds => format!("a sequence of kind {kinds}"),
    };
    Error::input(path, None, "kind", found, expected)
}
