//! Resuming a stopped run from its journal of finished parts.

use crate::printing::{Printing, note, warn};
use cloth_data::store::Recalled;
use serde::Serialize;

/// Identifies the program: the journal of another one is discarded. Development builds share a version number, so the
/// executable's size and modification time count too.
pub(super) fn program() -> impl Serialize {
    let file = std::env::current_exe().and_then(std::fs::metadata).ok();
    let file = file.map(|file| (file.len(), file.modified().ok()));
    (env!("CARGO_PKG_VERSION"), file)
}

/// Returns the records of a stopped run, and notes on standard error whether they are used.
pub(super) fn recalled<T>(recalled: Recalled<T>, printing: Printing, name: impl Fn(&T) -> String) -> Vec<T> {
    let Recalled { records, forgotten } = recalled;
    if forgotten {
        warn(printing, "discarded the results of an interrupted run: it had other input or settings");
    }
    if !records.is_empty() {
        let names: Vec<String> = records.iter().map(name).collect();
        note(printing, &format!("resuming an interrupted run; already finished: {}", names.join("; ")));
    }
    records
}
