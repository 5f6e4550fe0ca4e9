//! Force against extension or shear angle: the measured loop, and the model, one clip a sequence.

use super::chart::Drawn;
use super::cycle::{self, Point};
use cloth_fit::frame::{Kind, Phase};
use cloth_fit::report::{ForceRow, SequenceReport};

/// Draws all sequences of a kind.
///
/// # Errors
/// No forces at all.
pub(super) fn draw(title: &str, kind: Kind, sequences: &[&SequenceReport]) -> Drawn<String> {
    let point = |row: &ForceRow| Point {
        frame: row.frame,
        extension: row.extension,
        measured: row.measured.abs(),
        simulated: row.simulated.abs(),
        open: row.phase == Phase::Unloading,
    };
    let rows = sequences.iter().flat_map(|sequence| pulled_rows(&sequence.forces));
    let points: Vec<Point> = rows.map(point).collect();
    cycle::draw(title, kind, "clip force [N]", &points, ["measured, loading", "measured, unloading"])
}

/// The rows of the force component that is largest: the pull, on the clip where it was measured. Its direction may turn
/// with the clip; its place among the clip's components stays.
pub(crate) fn pulled_rows(rows: &[ForceRow]) -> Vec<&ForceRow> {
    let place = |index: usize| {
        let own = |row: &&ForceRow| row.frame == rows[index].frame && row.clip == rows[index].clip;
        (rows[index].clip, rows[..index].iter().filter(own).count())
    };
    let size = |index: &usize| rows[*index].measured.abs();
    let largest = (0..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b))).map(place);
    (0..rows.len()).filter(|&index| Some(place(index)) == largest).map(|index| &rows[index]).collect()
}
