//! Numerical interventions in solves and fits.

use super::list::list;
use cloth_fit::stage::interventions::Interventions;

/// One line with the counted interventions; empty if there were none.
pub(super) fn interventions(interventions: &Interventions) -> String {
    match interventions.in_words()[..] {
        [] => String::new(),
        ref words => format!("  interventions: {}\n", list(words)),
    }
}
