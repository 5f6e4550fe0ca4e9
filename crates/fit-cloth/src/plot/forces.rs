//! Force against extension or shear angle: measured on loading and unloading, and the model, one clip a sequence.

use super::chart::{Axes, Drawn, figure};
use super::{LOADING, MODEL, UNLOADING, extension};
use cloth_fit::frame::{Kind, Phase};
use cloth_fit::report::{ForceRow, SequenceReport};
use plotters::style::Color;

/// Draws all sequences of a kind.
///
/// # Errors
/// No forces at all.
pub(super) fn draw(title: &str, kind: Kind, sequences: &[&SequenceReport]) -> Drawn<String> {
    let rows: Vec<&ForceRow> = sequences.iter().flat_map(|s| pulled_rows(&s.forces)).collect();
    if rows.is_empty() {
        return Err("no forces".into());
    }
    let widest = rows.iter().map(|row| row.extension).fold(0.0, f64::max);
    let highest = rows.iter().map(|row| row.measured.abs().max(row.simulated.abs())).fold(0.0, f64::max);
    let axes =
        Axes { title, x: (extension(kind), 0.0..widest * 1.03), y: ("clip force [N]", 0.0..highest * 1.06) };
    figure(axes, |chart| {
        chart.line(rows.iter().map(|row| (row.frame, row.extension, row.simulated.abs())), MODEL, "model")?;
        let measured = [(false, "measured, loading", LOADING), (true, "measured, unloading", UNLOADING)];
        for (unloading, label, colour) in measured {
            let branch = rows.iter().filter(|row| (row.phase == Phase::Unloading) == unloading);
            let points: Vec<_> = branch.map(|row| (row.extension, row.measured.abs())).collect();
            if !points.is_empty() {
                chart.dots(points, (6, colour.stroke_width(2)), label)?;
            }
        }
        Ok(())
    })
}

/// The rows of the force component that is largest: the pull, on the clip where it was measured. Its direction may turn
/// with the clip; its place among the clip's components stays.
fn pulled_rows(rows: &[ForceRow]) -> Vec<&ForceRow> {
    let place = |index: usize| {
        let own = |row: &&ForceRow| row.frame == rows[index].frame && row.clip == rows[index].clip;
        (rows[index].clip, rows[..index].iter().filter(own).count())
    };
    let size = |index: &usize| rows[*index].measured.abs();
    let largest = (0..rows.len()).max_by(|a, b| size(a).total_cmp(&size(b))).map(place);
    (0..rows.len()).filter(|&index| Some(place(index)) == largest).map(|index| &rows[index]).collect()
}
