//! Residuals of every sequence.

use super::number::{cell, percent};
use cloth_fit::incremental::FitReport;
use std::fmt::Write;

/// One row per sequence.
pub fn residuals(report: &FitReport) -> String {
    let sequences = report.sequences();
    let width = sequences.iter().map(|(_, s)| s.name.chars().count()).max().unwrap_or(0).max(8);
    let mut text = format!(
        "{:width$}  frames  left out  several equilibria  nodes    rms force [N]  of largest  rms position [mm]  loading  unloading\n",
        "sequence"
    );
    for (stage, s) in sequences {
        let share = s.force_rms.map(|rms| rms / s.force_largest.max(f64::MIN_POSITIVE));
        let _ = writeln!(
            text,
            "{:width$}  {:6}  {:8}  {:18}  {:7}  {:>13}  {:>10}  {:>17}  {:>7}  {:>9}",
            s.name,
            s.frames,
            stage.left_out(s),
            s.multi_stable.len(),
            format!("{}x{}", s.nodes[0], s.nodes[1]),
            cell(s.force_rms, 5),
            percent(share),
            cell(s.position_rms.map(|rms| 1e3 * rms), 4),
            cell(s.hysteresis.map(|h| h.loading), 3),
            cell(s.hysteresis.map(|h| h.unloading), 3),
        );
    }
    text
}
