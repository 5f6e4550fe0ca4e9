//! Clip names in tables.

use super::source::{shortened, shown};
use super::table::Table;
use crate::error::Result;
use crate::frame::Clip;

/// Index of the clip named in a field.
pub(super) fn index_of(table: &Table, row: usize, column: usize, clips: &[Clip]) -> Result<usize> {
    let name = table.text(row, column);
    clips.iter().position(|clip| clip.name == name).ok_or_else(|| {
        let known: Vec<_> = clips.iter().map(|clip| clip.name.as_str()).collect();
        let known = shortened(&known.join(", "), 300);
        table.invalid(row, "clip", shown(name), format!("a clip of test.toml: {known}"))
    })
}

/// A name as a table field, quoted.
pub(super) fn quoted(name: &str) -> String {
    if name.contains([',', '"', ';', '\t']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.into()
    }
}
