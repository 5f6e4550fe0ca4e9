//! The residual of each curve, step by step.

use super::chart::{Axes, half_log_figure};
use super::drawing::Drawn;
use super::palette::{BLUE, GREEN, ORANGE, PINK, SKY, VERMILLION};
use cloth_fit::incremental::FitReport;
use plotters::style::{Color, RGBColor};

/// One colour per component, in order.
const COLOURS: [RGBColor; 6] = [BLUE, VERMILLION, GREEN, PINK, ORANGE, SKY];

/// # Errors
/// No curve.
pub(super) fn draw(report: &FitReport) -> Drawn<String> {
    let course = |rms: &[f64]| -> Vec<(f64, f64)> {
        let share = |(step, residual): (usize, &f64)| {
            let share = residual / rms[rms.len() - 1];
            // A zero residual cannot be drawn on a logarithmic axis; the legend says so.
            ((step + 1) as f64, if share > 0.0 { share } else { f64::NAN })
        };
        match rms {
            // The fit started at its minimum.
            [] => vec![(0.0, 1.0)],
            _ => rms.iter().enumerate().map(share).collect(),
        }
    };
    let stages = report.last_stages();
    let courses: Vec<(String, Vec<(f64, f64)>)> =
        stages.map(|stage| (stage.name(), course(&report.course(stage)))).collect();
    if courses.is_empty() {
        return Err("no curves".into());
    }
    let points = || courses.iter().flat_map(|(_, course)| course).filter(|(_, share)| share.is_finite());
    let longest = points().map(|point| point.0).fold(0.0, f64::max);
    let [low, high] =
        points().fold([1.0, 1.0], |[low, high]: [f64; 2], (_, share)| [low.min(*share), high.max(*share)]);
    let title = format!("Residual of each curve, {}", report.model);
    let axes = Axes {
        title: &title,
        x: ("step tried", 0.0..longest.max(8.0) + 0.5),
        y: ("rms residual over its last [–]", 0.9 * low..(1.2 * high).max(2.2)),
    };
    half_log_figure(axes, |chart| {
        for ((name, course), colour) in courses.iter().zip(COLOURS) {
            chart.paths([course.clone()], colour.stroke_width(4), "");
            chart.dots(course.iter().copied(), (6, colour.filled()), name);
        }
    })
}
