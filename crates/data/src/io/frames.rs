//! `frames.csv`: time, load cycle and phase of every frame.

use super::source::shown;
use super::table::Table;
use crate::error::{Error, Result};
use crate::frame::{Frame, Phase};
use crate::store::write_file;
use std::path::Path;

const OPTIONAL: [&str; 3] = ["time_s", "cycle", "phase"];
const PHASES: [(&str, Phase); 3] =
    [("loading", Phase::Loading), ("unloading", Phase::Unloading), ("hold", Phase::Hold)];

/// Reads one row per frame, in any order.
pub(super) fn read(path: &Path, frames: &mut [Frame]) -> Result<()> {
    let table = Table::read(path)?;
    let ([number], [time, cycle, phase]) = table.require(["frame"], OPTIONAL)?;
    let count = frames.len();
    let mut seen = vec![false; count];
    for row in 0..table.rows() {
        let index = table.index(row, number)?;
        let (Some(frame), Some(seen)) = (frames.get_mut(index), seen.get_mut(index)) else {
            let expected = format!("0 to {}, the frames of the sequence", count.saturating_sub(1));
            return Err(table.invalid(row, "frame", index.to_string(), expected));
        };
        if std::mem::replace(seen, true) {
            return Err(table.invalid(row, "frame", format!("{index} twice"), "every frame once"));
        }
        frame.time = time.map(|column| table.number(row, column)).transpose()?;
        frame.cycle = cycle.map(|column| table.index(row, column)).transpose()?;
        frame.phase = phase.map(|column| read_phase(&table, row, column)).transpose()?;
    }
    match seen.iter().position(|&seen| !seen) {
        Some(index) => {
            Err(table.incomplete("frame", format!("no frame {index}"), format!("0 to {}", count - 1)))
        }
        None => Ok(()),
    }
}

/// Writes `frames.csv` if any of these values is known.
pub(super) fn write(path: &Path, frames: &[Frame]) -> Result<()> {
    let time = column("time", frames.iter().map(|frame| frame.time.map(|time| time.to_string())))?;
    let cycle = column("cycle", frames.iter().map(|frame| frame.cycle.map(|cycle| cycle.to_string())))?;
    let phase = column("phase", frames.iter().map(|frame| frame.phase.map(|phase| name(phase).to_string())))?;
    let columns: Vec<_> = OPTIONAL
        .into_iter()
        .zip([time, cycle, phase])
        .filter_map(|(name, column)| Some((name, column?)))
        .collect();
    if columns.is_empty() {
        return Ok(());
    }
    let row = |first: String, rest: Vec<&str>| format!("{first},{}\n", rest.join(","));
    let mut text = row("frame".into(), columns.iter().map(|(name, _)| *name).collect());
    for index in 0..frames.len() {
        text += &row(index.to_string(), columns.iter().map(|(_, fields)| fields[index].as_str()).collect());
    }
    write_file(path, text.as_bytes())
}

/// Fields of a column; `None` if no frame has a value.
fn column(name: &'static str, fields: impl Iterator<Item = Option<String>>) -> Result<Option<Vec<String>>> {
    let fields: Vec<_> = fields.collect();
    let known = fields.iter().flatten().count();
    if known == 0 {
        return Ok(None);
    }
    fields.into_iter().collect::<Option<_>>().map(Some).ok_or_else(|| Error::Setting {
        field: name,
        found: format!("a value in {known} frames only"),
        expected: "a value in every frame of a sequence, or in none".into(),
    })
}

fn read_phase(table: &Table, row: usize, column: usize) -> Result<Phase> {
    let text = table.text(row, column);
    let found = PHASES.into_iter().find(|(name, _)| *name == text);
    found
        .map(|(_, phase)| phase)
        .ok_or_else(|| table.invalid(row, "phase", shown(text), "loading, unloading or hold"))
}

fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Loading => "loading",
        Phase::Unloading => "unloading",
        Phase::Hold => "hold",
    }
}
