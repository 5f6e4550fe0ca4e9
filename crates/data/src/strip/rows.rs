//! Row selection and the range of clamp distances.

use crate::error::Result;
use crate::io::table::Table;
use std::ops::{Range, RangeInclusive};

/// Clamp distances of a tensile test in gauge lengths; other values indicate another unit or quantity.
pub(super) const SEPARATION: RangeInclusive<f64> = 0.5..=10.0;

/// Selected rows, from 0.
pub(super) fn chosen_rows(table: &Table, rows: Option<&RangeInclusive<usize>>) -> Result<Range<usize>> {
    let count = table.rows();
    if count == 0 {
        return Err(table.incomplete("row", "nothing below the header", "at least one row"));
    }
    let Some(rows) = rows else { return Ok(0..count) };
    let (first, last) = (*rows.start(), *rows.end());
    if first == 0 || first > last.min(count) || (last > count && last != usize::MAX) {
        let last = if last == usize::MAX { "the last".into() } else { last.to_string() };
        let found = format!("rows {first} to {last} asked for");
        return Err(table.incomplete("row", found, format!("rows from 1 to {count}")));
    }
    Ok(first - 1..last.min(count))
}
