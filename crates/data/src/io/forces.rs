//! `forces.csv`: cord forces on the clips.

use super::names::{index_of, quoted};
use super::table::Table;
use crate::error::{Error, Result};
use crate::frame::{Clip, Cord, Frame};
use crate::store::write_file;
use nalgebra::Vector3;
use std::path::Path;

const COLUMNS: [&str; 5] = ["frame", "clip", "fx_n", "fy_n", "fz_n"];
const POINT: [&str; 3] = ["px_m", "py_m", "pz_m"];

/// Reads the cords and assigns them to their frames in file order.
pub(super) fn read(path: &Path, clips: &[Clip], frames: &mut [Frame]) -> Result<()> {
    let table = Table::read(path)?;
    let ([frame, clip, fx, fy, fz], point) = table.require(COLUMNS, POINT)?;
    let point = match point {
        [Some(x), Some(y), Some(z)] => Some([x, y, z]),
        [None, None, None] => None,
        _ => return Err(table.bad_header("header", "a part of px_m, py_m, pz_m", "all three or none")),
    };
    for row in 0..table.rows() {
        let vector = |[x, y, z]: [usize; 3]| -> Result<_> {
            Ok(Vector3::new(table.number(row, x)?, table.number(row, y)?, table.number(row, z)?))
        };
        let index = table.index(row, frame)?;
        let clip = index_of(&table, row, clip, clips)?;
        let cord = Cord { clip, force: vector([fx, fy, fz])?, point: point.map(vector).transpose()? };
        let last = frames.len().saturating_sub(1);
        match frames.get_mut(index) {
            Some(frame) => frame.cords.push(cord),
            None => {
                let expected = format!("0 to {last}, the frames of clips.csv");
                return Err(table.invalid(row, "frame", index.to_string(), expected));
            }
        }
    }
    Ok(())
}

/// Writes `forces.csv` if any force was measured.
pub(super) fn write(path: &Path, clips: &[Clip], frames: &[Frame]) -> Result<()> {
    let points: Vec<_> =
        frames.iter().flat_map(|frame| &frame.cords).map(|cord| cord.point.is_some()).collect();
    let Some(&pointed) = points.first() else { return Ok(()) };
    if points.contains(&!pointed) {
        return Err(Error::Setting {
            field: "cords[].point",
            found: "a point for some cords only".into(),
            expected: "a point for every cord of a sequence, or for none".into(),
        });
    }
    let mut text = COLUMNS.join(",");
    if pointed {
        text = format!("{text},{}", POINT.join(","));
    }
    text.push('\n');
    for (index, frame) in frames.iter().enumerate() {
        for cord in &frame.cords {
            let numbers = cord.force.iter().chain(cord.point.iter().flat_map(|point| point.iter()));
            let numbers: Vec<_> = numbers.map(f64::to_string).collect();
            text += &format!("{index},{},{}\n", quoted(&clips[cord.clip].name), numbers.join(","));
        }
    }
    write_file(path, text.as_bytes())
}
