//! A measure of the whole against extension: measured, and the model, frame by frame.

use super::chart::{Axes, Drawn, figure};
use super::{LOADING, MODEL, UNLOADING, extension};
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
    figure(axes, |chart| {
        let simulated = rows.iter().map(|row| (row.frame, row.extension, row.simulated));
        chart.line(simulated, MODEL, "model")?;
        let measured = [(false, "measured", LOADING), (true, "measured, several equilibria", UNLOADING)];
        for (several, label, colour) in measured {
            let shown = rows.iter().filter(|row| row.multi_stable == several);
            let points: Vec<_> = shown.map(|row| (row.extension, row.measured)).collect();
            if !points.is_empty() {
                chart.dots(points, (6, colour.stroke_width(2)), label)?;
            }
        }
        Ok(())
    })
}
