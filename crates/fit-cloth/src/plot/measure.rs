//! A measure of the whole sheet against extension: measured and simulated, frame by frame.

use super::cycle::{self, Point};
use super::drawing::Drawn;
use cloth_data::frame::Kind;
use cloth_data::kind::Summary;
use cloth_fit::judge::validation::MeasureRow;

/// # Errors
/// No frame.
pub(super) fn draw(title: &str, kind: Kind, measure: Summary, rows: &[MeasureRow]) -> Drawn<String> {
    let point = |row: &MeasureRow| Point {
        frame: row.frame,
        extension: row.extension,
        measured: row.measured,
        simulated: row.simulated,
        open: row.multi_stable,
    };
    let points: Vec<Point> = rows.iter().map(point).collect();
    let name = format!("{measure} [{}]", measure.unit());
    cycle::draw(title, kind, &name, &points, ["measured", "measured, several equilibria"])
}
