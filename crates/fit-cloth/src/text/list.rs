//! Lists in a sentence.

use std::fmt::Display;

/// Joins items by commas.
pub(super) fn list(items: impl IntoIterator<Item = impl Display>) -> String {
    items.into_iter().map(|item| item.to_string()).collect::<Vec<_>>().join(", ")
}
