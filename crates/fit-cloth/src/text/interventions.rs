//! What helped solves and fits along.

use super::list::list;
use cloth_fit::stage::interventions::Interventions;

/// What helped solves and fits along, on a line; nothing where nothing did.
pub(super) fn interventions(interventions: &Interventions) -> String {
    match interventions.in_words()[..] {
        [] => String::new(),
        ref words => format!("  helped along by: {}\n", list(words)),
    }
}
