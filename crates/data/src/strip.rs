//! Imports a table of a tensile machine as a stretch sequence: a strip between two clamps, one of which moves.
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
//! Frame 0 is the strip at rest, with the clamps at the free length and no known force. Every selected row adds one
//! frame: the moving clamp shifted along the pull, and the load cell reading as the force of its cord. No shapes are
//! measured.
//!
//! ```text
//! force F = reading − zero       separation = gauge length + displacement − compliance · F
//! ```

mod column;
mod force_table;
mod rows;
mod set;
mod settings;
#[cfg(test)]
mod tests;

pub use column::Column;
pub use force_table::{Conversion, ForceTable, read_force_table};
pub use set::{Added, FabricFields, add_to_set};
pub use settings::{Direction, Extension, FreeLength, StripTest};

use crate::branch::{numbered, phases};
use crate::error::{Error, Result};
use crate::frame::{Clip, Cord, Frame, Noise, Phase, Sequence};
use crate::inspection::pull::{self, Reading};
use crate::io::shortened;
use crate::io::table::Table;
use crate::notice::Notice;
use column::{Quantity, Series};
use nalgebra::{Isometry3, Vector3};
use rows::{SEPARATION, chosen_rows};
use std::collections::BTreeMap;
use std::path::Path;

/// Largest plausible share of the extension due to machine compliance.
const MOST_COMPLIANT: f64 = 0.3;
/// Default name of the branch column.
const BRANCH: &str = "branch";

/// An imported strip test.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// The sequence: rest state, then one frame per row.
    pub sequence: Sequence,
    /// Clamp distance at rest, m.
    pub free_length: f64,
    /// Source row of each frame, the first below the header is 1; 0 for the rest state.
    rows: Vec<usize>,
    /// Branch of each frame.
    branches: Vec<usize>,
    /// Rows that repeat the previous one.
    repeats: Vec<usize>,
    /// Name of the table.
    table: String,
    /// Share of the clamp travel attributed to machine compliance.
    compliant: f64,
}

impl Strip {
    /// Drops readings after a breakage and reports everything suspicious.
    ///
    /// * `areal_density` — of the cloth, kg/m²; if known, the magnitude of the forces is checked
    pub fn inspect(&mut self, areal_density: Option<f64>) -> Vec<Notice> {
        let counted = format!("{} row", self.table);
        let mut notices: Vec<Notice> = self.repeated(&counted).into_iter().chain(self.compliance()).collect();
        notices.extend(pull::inspect(&mut self.sequence, areal_density, &counted, &self.rows));
        self.rows.truncate(self.sequence.frames.len());
        self.branches.truncate(self.sequence.frames.len());
        notices
    }

    /// Selected rows; the first below the header is 1.
    pub fn rows(&self) -> &[usize] {
        &self.rows[1..]
    }

    /// Branches of those rows, in order.
    pub fn branches(&self) -> Vec<usize> {
        let mut branches = self.branches.clone();
        branches.dedup();
        branches
    }

    fn compliance(&self) -> Option<Notice> {
        (self.compliant > MOST_COMPLIANT).then(|| {
            Notice::doubt(
                &self.sequence.name,
                self.table.clone(),
                format!("a compliance that accounts for {:.0} % of the extension", 100.0 * self.compliant),
                "a machine much stiffer than the strip: check the unit, metres per newton, and the measurement of the compliance",
            )
        })
    }

    fn repeated(&self, counted: &str) -> Option<Notice> {
        let first = self.repeats.first()?;
        let count = self.repeats.len();
        let (rows, repeat) = if count == 1 { ("row", "repeats") } else { ("rows", "repeat") };
        Some(Notice::remark(
            &self.sequence.name,
            format!("{counted} {first}"),
            format!("{count} {rows} that {repeat} the one before"),
            "each reading once: the repeated rows are left out",
        ))
    }
}

/// Reads a table of a tensile machine. Columns that are not requested may contain anything.
///
/// The phase of a branch follows from its ends; its cycle is half its number. A row that repeats the previous one is
/// dropped.
///
/// # Errors
/// A setting outside its range; a file that is not a table; a missing column or unknown unit; a number that is not
/// finite; a clamp distance below half or above ten gauge lengths; rows or branches that do not exist; a preload that
/// no loading reaches.
pub fn read_strip(path: &Path, test: &StripTest) -> Result<Strip> {
    test.validate()?;
    let table = Table::read_columns(path, &test.columns())?;
    let readings = readings(&table, test)?;
    let phases = phases(readings.iter().map(|reading| (reading.branch, reading.separation)));
    let (taken, repeats) = without_repeats(taken(&table, test, &readings)?);
    let length = free_length(&table, test, &readings)?;
    if !taken.iter().any(|reading| reading.separation > length) {
        let found = format!("no clamp distance above the free length, {length} m");
        let expected = "an extension that grows with the pull: the other sign, or another free length";
        return Err(table.incomplete(&test.extension.column().name, found, expected));
    }
    let farthest = taken
        .iter()
        .map(|reading| reading.separation + test.compliance * reading.force - length)
        .fold(0.0, f64::max);
    let largest = taken.iter().map(|reading| (reading.force + test.zero).abs()).fold(0.0, f64::max);
    if test.zero.abs() > largest {
        return Err(Error::Setting {
            field: "zero",
            found: test.zero.to_string(),
            expected: format!("a reading without load: at most the largest force, {largest} N"),
        });
    }
    let (mesh, pull) =
        test.specimen(length).map_err(|source| Error::Mechanics { context: test.name.clone(), source })?;
    let frame = |branch: usize, phase, shift: f64, cords| Frame {
        time: None,
        cycle: Some(branch / 2),
        phase: Some(phase),
        poses: vec![Isometry3::identity(), Isometry3::translation(pull.x * shift, pull.y * shift, 0.0)],
        cords,
        positions: None,
    };
    let first = taken.first().map_or(0, |reading| reading.branch);
    let mut frames = vec![frame(first, Phase::Hold, 0.0, Vec::new())];
    frames.extend(taken.iter().map(|reading| {
        let cord = Cord { clip: 1, force: pull * reading.force, point: None };
        frame(reading.branch, phases[&reading.branch], reading.separation - length, vec![cord])
    }));
    let clip = |name: &str, vertices| Clip { name: name.into(), mass_kg: 0.0, vertices };
    let sequence = Sequence {
        name: test.name.clone(),
        kind: test.direction.kind(),
        gravity: Vector3::zeros(),
        noise: test.force_noise.map(|force| Noise { position_m: None, force_n: Some(force), clip_m: None }),
        force_direction: Some(pull),
        table: None,
        mesh,
        clips: vec![clip("fixed", vec![0, 1]), clip("moving", vec![2, 3])],
        frames,
    };
    Ok(Strip {
        sequence,
        free_length: length,
        rows: std::iter::once(0).chain(taken.iter().map(|reading| reading.number)).collect(),
        branches: std::iter::once(first).chain(taken.iter().map(|reading| reading.branch)).collect(),
        repeats,
        compliant: test.compliance * largest / farthest.max(f64::MIN_POSITIVE),
        table: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
    })
}

/// All candidate rows with their branches.
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
        let force = force.value(table, row)? - test.zero;
        let clamps = match test.extension {
            Extension::Separation(_) => value,
            Extension::Displacement(_) => test.gauge + value,
            Extension::Strain(_) => test.gauge * (1.0 + value),
        };
        let separation = clamps - test.compliance * force;
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
        readings.push(Reading { number: row + 1, branch, separation, force });
    }
    if branch.is_none() {
        let separations: Vec<_> = readings.iter().map(|reading| reading.separation).collect();
        for (reading, branch) in readings.iter_mut().zip(numbered(&separations)) {
            reading.branch = branch;
        }
    }
    Ok(readings)
}

/// Clamp distance of the straight, unloaded strip, m.
fn free_length(table: &Table, test: &StripTest, readings: &[Reading]) -> Result<f64> {
    let force = match test.free_length {
        FreeLength::Gauge => return Ok(test.gauge),
        FreeLength::Length(length) => return Ok(length),
        FreeLength::Preload(force) => force,
    };
    let loading = readings.chunk_by(|a, b| a.branch == b.branch).next().unwrap_or_default();
    let length = pull::free_length(loading, force);
    length.filter(|length| SEPARATION.contains(&(length / test.gauge))).ok_or_else(|| {
        let found = format!("a first loading that does not pass from zero through {force} N");
        table.incomplete(&test.force.name, found, "a preload within its range, or the free length itself")
    })
}

/// Merges rows that repeat the previous one: they are one reading with one noise.
fn without_repeats(rows: Vec<&Reading>) -> (Vec<&Reading>, Vec<usize>) {
    let mut repeats = Vec::new();
    let mut kept: Vec<&Reading> = Vec::with_capacity(rows.len());
    for row in rows {
        let same = |last: &&Reading| Reading { number: row.number, ..**last } == *row;
        match kept.last().is_some_and(same) {
            true => repeats.push(row.number),
            false => kept.push(row),
        }
    }
    (kept, repeats)
}

/// Rows of the requested branches, thinned out.
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
