//! Time saved by omitting each part, and the error this causes.

use super::bars::{self, Bar};
use crate::plot::drawing::Drawn;
use crate::plot::palette::{BLUE, VERMILLION};
use cloth_study::ablation::Ablated;
use cloth_study::run::Ending;
use cloth_study::study::Study;

/// # Errors
/// No part was omitted.
pub(super) fn draw(study: &Study) -> Drawn<String> {
    let bars: Vec<Bar> = study.ablation.iter().map(bar).collect();
    let lowest = bars.iter().map(|bar| bar.pieces[0].0).fold(0.0, f64::min);
    let legend = [("in by default", BLUE), ("left out by default", VERMILLION)];
    // Notes are beyond the longest bar.
    let extent = lowest.max(-100.0)..190.0;
    bars::draw(
        "Time saved by leaving out a part, and the error this causes",
        ("time saved [%], cut off at -100", extent),
        &legend,
        &bars,
    )
}

fn bar(row: &Ablated) -> Bar {
    let note = match (&row.ending[1], row.relative_error(), row.error_position_mm) {
        (Ending::Failed(_), ..) => "fails".into(),
        (_, Some(error), _) if error > 10.0 => "> 1000 %".into(),
        (_, Some(error), _) => format!("{} %", digits(100.0 * error)),
        (_, None, Some(millimetres)) => format!("{} mm", digits(millimetres)),
        _ => String::new(),
    };
    Bar {
        name: format!("{}, {}", row.scene, row.part),
        pieces: vec![(100.0 * row.saving().max(-1.0), if row.by_default { BLUE } else { VERMILLION })],
        note,
    }
}

/// Rounding errors are printed as zero.
fn digits(value: f64) -> String {
    match value.abs() {
        size if size < 1e-9 => "0".into(),
        size if size < 1e-2 => format!("{value:.0e}"),
        _ => format!("{value:.2}"),
    }
}
