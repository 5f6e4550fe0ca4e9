//! Force against extension or shear angle: the measured loop and the model, one clip per sequence.

use super::cycle::{self, Point};
use super::drawing::Drawn;
use crate::shown::pulled_rows;
use cloth_data::frame::{Kind, Phase};
use cloth_fit::stage::report::{ForceRow, SequenceReport};

/// Draws all sequences of one kind.
///
/// # Errors
/// No forces.
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
