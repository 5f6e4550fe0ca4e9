//! A measure of the whole against extension: measured, and the model, frame by frame.

use super::chart::{Axes, Drawn, figure};
use super::{MEASURED, MODEL, extension};
use cloth_fit::frame::Kind;
use cloth_fit::validation::{Measure, MeasureRow};
use plotters::style::Color;

pub(super) fn draw(title: &str, kind: Kind, measure: Measure, rows: &[MeasureRow]) -> Drawn<String> {
    let widest = rows.iter().map(|row| row.extension).fold(0.0, f64::max);
    let values = || rows.iter().flat_map(|row| [row.measured, row.simulated]);
    let [low, high] = [values().fold(0.0, f64::min), values().fold(0.0, f64::max)];
    let space = 0.06 * (high - low);
    let y = format!("{measure} [{}]", measure.unit());
    let axes = Axes {
        title,
        x: (extension(kind), 0.0..widest * 1.03),
        y: (&y, if low < 0.0 { low - space } else { 0.0 }..high + space),
    };
    let line =
        |value: fn(&MeasureRow) -> f64| rows.iter().map(move |row| (row.frame, row.extension, value(row)));
    figure(axes, |chart| {
        chart.line(line(|row| row.simulated), MODEL.stroke_width(8), "model");
        chart.line(line(|row| row.measured), MEASURED.stroke_width(2), "");
        let measured = [
            ("measured", MEASURED.filled(), false),
            ("measured, several equilibria", MEASURED.stroke_width(2), true),
        ];
        for (label, style, several) in measured {
            let shown = rows.iter().filter(|row| row.multi_stable == several);
            chart.dots(shown.map(|row| (row.extension, row.measured)), (6, style), label);
        }
    })
}
