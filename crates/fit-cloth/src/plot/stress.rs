//! Stress against strain, or moment against curvature, with its 95 % band and the control points.

use super::MODEL;
use super::chart::{Axes, Drawn, figure};
use cloth_fit::report::{Sample, StageReport};
use plotters::style::Color;

pub(super) fn draw(stage: &StageReport) -> Drawn<String> {
    let samples = &stage.curve.samples;
    let highest = |sample: &Sample| sample.band.map_or(sample.stress, |[_, high]| high);
    let lowest = |sample: &Sample| sample.band.map_or(sample.stress, |[low, _]| low);
    let top = samples.iter().map(highest).fold(0.0, f64::max);
    let bottom = samples.iter().map(lowest).fold(0.0, f64::min);
    let [low, high] = [&samples[0], &samples[samples.len() - 1]].map(|sample| sample.strain);
    let [x, y] = match stage.components[0].is_bending() {
        true => ["curvature [1/m]", "moment per width [N]"],
        false => ["strain", "stress [N/m]"],
    };
    let title = format!("{}, {}", stage.name(), stage.model);
    let axes = Axes { title: &title, x: (x, low..high * 1.03), y: (y, bottom..top * 1.06) };
    figure(axes, |chart| {
        let upper = samples.iter().filter_map(|s| s.band.map(|[_, high]| (s.strain, high)));
        let lower = samples.iter().rev().filter_map(|s| s.band.map(|[low, _]| (s.strain, low)));
        chart.band(upper.chain(lower).collect(), MODEL)?;
        let curve = samples.iter().enumerate().map(|(i, s)| (i, s.strain, s.stress));
        chart.line(curve, MODEL, "fit, 95 % band")?;
        // The last may lie beyond what was seen.
        let points = stage.curve.points.iter().filter(|point| point.strain <= high * 1.03);
        chart.dots(points.map(|point| (point.strain, point.stress)), (8, MODEL.filled()), "control points")
    })
}
