//! Force against extension or shear angle: the measured loop, and the model, one clip a sequence.

use super::chart::{Axes, Drawn, figure};
use super::{MEASURED, MODEL, extension};
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
    let line = |force: fn(&ForceRow) -> f64| {
        rows.iter().map(move |row| (row.frame, row.extension, force(row).abs()))
    };
    figure(axes, |chart| {
        chart.line(line(|row| row.simulated), MODEL.stroke_width(8), "model");
        chart.line(line(|row| row.measured), MEASURED.stroke_width(2), "");
        let measured = [
            ("measured, loading", MEASURED.filled(), false),
            ("measured, unloading", MEASURED.stroke_width(2), true),
        ];
        for (label, style, unloading) in measured {
            let branch = rows.iter().filter(|row| (row.phase == Phase::Unloading) == unloading);
            chart.dots(branch.map(|row| (row.extension, row.measured.abs())), (6, style), label);
        }
    })
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
