//! A tensile machine's table as a stretch sequence: a strip between two clamps, one of which moves.
//!
//! ```text
//!   weft, bias                            warp   y
//!   y                                            │ ┌─────┐ moving, pulled along +y
//!   │ fixed ┌────────────┐ moving,               │ │     │
//!   │       │            │ pulled along +x       │ │     │
//!   └───────└────────────┘─────── x              └─└─────┘ fixed ─── x
//!           ‹── gauge ───›                         ‹width›
//! ```
//!
//! Frame 0 is the strip at rest, the clamps a gauge length apart and no force known. Every row taken is one frame
//! more: the moving clamp shifted along the pull, the load cell's reading as the cord on it. No shape was measured.

mod branch;
mod column;
mod force_table;
mod set;
mod settings;
#[cfg(test)]
mod tests;

pub use column::Column;
pub use force_table::{ForceTable, Measure, read_force_table};
pub use set::{Added, Sample, add_to_set};
pub use settings::{Direction, Extension, StripTest};

use crate::error::{Error, Result};
use crate::frame::{Clip, Cord, Frame, Noise, Phase, Sequence};
use crate::io::shortened;
use crate::io::table::Table;
use branch::{numbered, phases};
use column::{Quantity, Series};
use nalgebra::{Isometry3, Vector3};
use settings::LARGEST;
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

/// The column of branches that is looked for if none is named.
const BRANCH: &str = "branch";
/// The clamps of a tensile test are this many gauge lengths apart; other values are another unit or quantity.
const SEPARATION: RangeInclusive<f64> = 0.5..=10.0;

/// A row of the table.
struct Reading {
    branch: usize,
    /// Of the clamps, m.
    separation: f64,
    /// N.
    force: f64,
}

/// Reads a tensile machine's table. Columns that are not asked for may hold anything.
///
/// The phase of a branch follows from where it begins and ends; its cycle is half its number.
///
/// # Errors
/// A setting outside what it may be; not a table; a column that is missing or whose unit is not known; a number that
/// is not finite; clamps less than half a gauge length apart or more than ten; rows or branches that do not exist.
pub fn read_strip(path: &Path, test: &StripTest) -> Result<Sequence> {
    test.validate()?;
    let (mesh, pull) =
        test.specimen().map_err(|source| Error::Mechanics { context: test.name.clone(), source })?;
    let table = Table::read_columns(path, &test.columns())?;
    let readings = readings(&table, test)?;
    let phases = phases(readings.iter().map(|reading| (reading.branch, reading.separation)));
    let frame = |branch: usize, phase, shift: f64, cords| Frame {
        time: None,
        cycle: Some(branch / 2),
        phase: Some(phase),
        poses: vec![Isometry3::identity(), Isometry3::translation(pull.x * shift, pull.y * shift, 0.0)],
        cords,
        positions: None,
    };
    let taken = taken(&table, test, &readings)?;
    let first = taken.first().map_or(0, |reading| reading.branch);
    let mut frames = vec![frame(first, Phase::Hold, 0.0, Vec::new())];
    frames.extend(taken.iter().map(|reading| {
        let cord = Cord { clip: 1, force: pull * reading.force, point: None };
        frame(reading.branch, phases[&reading.branch], reading.separation - test.gauge, vec![cord])
    }));
    let clip = |name: &str, vertices| Clip { name: name.into(), mass_kg: 0.0, vertices };
    Ok(Sequence {
        name: test.name.clone(),
        kind: test.direction.kind(),
        gravity: Vector3::zeros(),
        noise: test.force_noise.map(|force| Noise { position_m: None, force_n: Some(force) }),
        force_direction: Some(pull),
        table: None,
        mesh,
        clips: vec![clip("fixed", vec![0, 1]), clip("moving", vec![2, 3])],
        frames,
    })
}

/// All rows that may be looked at, with their branches.
fn readings(table: &Table, test: &StripTest) -> Result<Vec<Reading>> {
    let (column, quantity) = match &test.extension {
        Extension::Separation(column) | Extension::Displacement(column) => (column, Quantity::Length),
        Extension::Strain(column) => (column, Quantity::Strain),
    };
    let extension = Series::find(table, column, quantity)?;
    let force = Series::find(table, &test.force, Quantity::Force)?;
    let branch = match &test.branch_column {
        Some(name) => Some(table.place(name)?),
        None => table.column(BRANCH).map(|_| table.place(BRANCH)).transpose()?,
    };
    let mut readings = Vec::new();
    for row in chosen_rows(table, test.rows.as_ref())? {
        let value = extension.value(table, row)?;
        let separation = match test.extension {
            Extension::Separation(_) => value,
            Extension::Displacement(_) => test.gauge + value,
            Extension::Strain(_) => test.gauge * (1.0 + value),
        };
        if !SEPARATION.contains(&(separation / test.gauge)) {
            let found = format!("clamps {separation} m apart");
            let expected = format!(
                "{} to {} gauge lengths of {} m (another unit, or another of separation, displacement and strain?)",
                SEPARATION.start(),
                SEPARATION.end(),
                test.gauge
            );
            return Err(table.invalid(row, &column.name, found, expected));
        }
        let branch = branch.map_or(Ok(0), |branch| table.index(row, branch))?;
        readings.push(Reading { branch, separation, force: force.value(table, row)? });
    }
    if branch.is_none() {
        let separations: Vec<_> = readings.iter().map(|reading| reading.separation).collect();
        for (reading, branch) in readings.iter_mut().zip(numbered(&separations)) {
            reading.branch = branch;
        }
    }
    Ok(readings)
}

/// The rows that may be looked at, from 0.
fn chosen_rows(table: &Table, rows: Option<&RangeInclusive<usize>>) -> Result<Range<usize>> {
    let count = table.rows();
    if count == 0 {
        return Err(table.incomplete("row", "nothing below the header", "one row at least"));
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

/// The rows of the branches asked for, thinned out.
fn taken<'a>(table: &Table, test: &StripTest, readings: &'a [Reading]) -> Result<Vec<&'a Reading>> {
    let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
    let mut taken = Vec::new();
    for reading in readings {
        let count = seen.entry(reading.branch).or_default();
        let wanted = test.branches.as_ref().is_none_or(|branches| branches.contains(&reading.branch));
        if wanted && count.is_multiple_of(test.every) {
            taken.push(reading);
        }
        *count += 1;
    }
    match test.branches.iter().flatten().find(|branch| !seen.contains_key(branch)) {
        Some(branch) => {
            let present: Vec<_> = seen.keys().map(usize::to_string).collect();
            let found = format!("no row of branch {branch}");
            let expected = format!("branches that the table has: {}", shortened(&present.join(", "), 300));
            Err(table.incomplete(test.branch_column.as_deref().unwrap_or(BRANCH), found, expected))
        }
        None => Ok(taken),
    }
}
