//! What a run that was stopped has finished, for the same command to go on after.

use crate::telling::{Telling, note, warn};
use cloth_data::store::Recalled;
use serde::Serialize;

/// Which program this is: a journal of another one is of no use. A build in development keeps its version number, so
/// the file's age and size count too.
pub(super) fn program() -> impl Serialize {
    let file = std::env::current_exe().and_then(std::fs::metadata).ok();
    let file = file.map(|file| (file.len(), file.modified().ok()));
    (env!("CARGO_PKG_VERSION"), file)
}

/// The records of a run that was stopped; says on standard error that they are used, or not.
pub(super) fn recalled<T>(recalled: Recalled<T>, telling: Telling, name: impl Fn(&T) -> String) -> Vec<T> {
    let Recalled { records, forgotten } = recalled;
    if forgotten {
        warn(
            telling,
            "what an interrupted run had finished was of other input or settings, and is forgotten",
        );
    }
    if !records.is_empty() {
        let names: Vec<String> = records.iter().map(name).collect();
        note(telling, &format!("going on after what an interrupted run has finished: {}", names.join("; ")));
    }
    records
}
