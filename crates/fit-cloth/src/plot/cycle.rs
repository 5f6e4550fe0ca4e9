//! A quantity measured and simulated in every frame, against the extension: measured thin, model thick.

use super::chart::{Axes, figure};
use super::drawing::Drawn;
use super::palette::{MEASURED, MODEL};
use crate::shown::extension;
use cloth_data::frame::Kind;
use plotters::style::Color;

/// A frame of the figure.
pub(super) struct Point {
    /// Index in the sequence; lines are interrupted at missing frames.
    pub(super) frame: usize,
    pub(super) extension: f64,
    pub(super) measured: f64,
    pub(super) simulated: f64,
    /// Draw as an open dot: a frame of the second kind.
    pub(super) open: bool,
}

/// Draws the frames in order.
///
/// * `name` — the measured quantity with its unit
/// * `kinds` — legend entries for measured frames of the first and second kind
///
/// # Errors
/// No frame, or frames without extent.
pub(super) fn draw(title: &str, kind: Kind, name: &str, points: &[Point], kinds: [&str; 2]) -> Drawn<String> {
    if points.is_empty() {
        return Err("no frames".into());
    }
    let widest = points.iter().map(|point| point.extension).fold(0.0, f64::max);
    let values = || points.iter().flat_map(|point| [point.measured, point.simulated]);
    let [low, high] = [values().fold(0.0, f64::min), values().fold(0.0, f64::max)];
    let space = 0.06 * (high - low);
    let axes = Axes {
        title,
        x: (extension(kind), 0.0..widest * 1.03),
        y: (name, if low < 0.0 { low - space } else { 0.0 }..high + space),
    };
    let line = |value: fn(&Point) -> f64| {
        points.iter().map(move |point| (point.frame, point.extension, value(point)))
    };
    figure(axes, |chart| {
        chart.line(line(|point| point.simulated), MODEL.stroke_width(8), "model");
        chart.line(line(|point| point.measured), MEASURED.stroke_width(2), "");
        let styles = [MEASURED.filled(), MEASURED.stroke_width(2)];
        for ((label, style), open) in kinds.into_iter().zip(styles).zip([false, true]) {
            let shown = points.iter().filter(|point| point.open == open);
            chart.dots(shown.map(|point| (point.extension, point.measured)), (6, style), label);
        }
    })
}
