//! `clips.csv`: the pose of every clip in every frame.

use super::names::index_of;
use super::source::shown;
use super::table::Table;
use super::test_file::UNIT_LENGTH;
use crate::error::{Error, Result};
use crate::frame::{Clip, Frame};
use crate::store::write_file;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use std::collections::BTreeMap;
use std::path::Path;

const COLUMNS: [&str; 9] = ["frame", "clip", "tx_m", "ty_m", "tz_m", "qw", "qx", "qy", "qz"];

/// Largest displacement of a clip by the rounding of its quaternion, m: the resolution of cameras.
const MOVED: f64 = 1e-4;

/// Reads one pose per clip and frame; rows may be in any order.
///
/// * `reach` — largest distance of the specimen from the origin, the centre of rotation of the poses, m
pub(super) fn read(path: &Path, clips: &[Clip], reach: f64) -> Result<Vec<Vec<Isometry3<f64>>>> {
    let table = Table::read(path)?;
    let ([frame, clip, tx, ty, tz, qw, qx, qy, qz], []) = table.require(COLUMNS, [])?;
    let mut poses = BTreeMap::new();
    for row in 0..table.rows() {
        let number = |column| table.number(row, column);
        let key = (table.index(row, frame)?, index_of(&table, row, clip, clips)?);
        let translation = Translation3::new(number(tx)?, number(ty)?, number(tz)?);
        let quaternion = Quaternion::new(number(qw)?, number(qx)?, number(qy)?, number(qz)?);
        let pose = Isometry3::from_parts(translation, rotation(&table, row, quaternion, reach)?);
        if poses.insert(key, pose).is_some() {
            let found = format!("frame {} of {} twice", key.0, shown(&clips[key.1].name));
            return Err(table.invalid(row, "frame", found, "one pose for every clip and frame"));
        }
    }
    // In order of frame and clip the n-th key is known.
    let keys = poses.keys().copied().map(Some).chain([None]);
    for (count, key) in keys.enumerate() {
        let expected = (count / clips.len(), count % clips.len());
        let complete = key.is_none() && count > 0 && expected.1 == 0;
        if key != Some(expected) && !complete {
            let found = format!("no pose of {} in frame {}", shown(&clips[expected.1].name), expected.0);
            return Err(table.incomplete(
                "frame",
                found,
                "one pose for every clip and frame, from frame 0 on",
            ));
        }
    }
    let poses: Vec<_> = poses.into_values().collect();
    Ok(poses.chunks(clips.len()).map(<[_]>::to_vec).collect())
}

/// Writes `clips.csv` if there are clips.
pub(super) fn write(path: &Path, clips: &[Clip], frames: &[Frame]) -> Result<()> {
    if clips.is_empty() {
        return Ok(());
    }
    let mut text = COLUMNS.join(",") + "\n";
    for (index, frame) in frames.iter().enumerate() {
        for (clip, pose) in clips.iter().zip(&frame.poses) {
            let (t, q) = (&pose.translation, &pose.rotation);
            let name = super::names::quoted(&clip.name);
            let numbers = [t.x, t.y, t.z, q.w, q.i, q.j, q.k].map(|value| value.to_string()).join(",");
            text += &format!("{index},{name},{numbers}\n");
        }
    }
    write_file(path, text.as_bytes())
}

/// Accepts unit length within 1e-6 and normalises the quaternion, unless only the last digits are rounded.
fn rotation(
    table: &Table,
    row: usize,
    quaternion: Quaternion<f64>,
    reach: f64,
) -> Result<UnitQuaternion<f64>> {
    let error = (quaternion.norm() - 1.0).abs();
    if error > UNIT_LENGTH {
        let found = format!("a quaternion of length {}", quaternion.norm());
        let expected = "unit length: qw first, then qx, qy, qz";
        return Err::<_, Error>(table.invalid(row, "qw,qx,qy,qz", found, expected));
    }
    // The error of the length estimates that of the direction; the last digits always carry rounding.
    if error > 1e-14 && error * reach > MOVED {
        let found = format!("a quaternion whose length errs by {error:.1e}, {reach:.0} m from the origin");
        let expected = "more digits, or a nearer origin: poses rotate about it";
        return Err(table.invalid(row, "qw,qx,qy,qz", found, expected));
    }
    Ok(if error < 1e-14 {
        UnitQuaternion::new_unchecked(quaternion)
    } else {
        UnitQuaternion::new_normalize(quaternion)
    })
}
