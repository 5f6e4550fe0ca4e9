//! Curve error against noise, with the Cramér–Rao bound.

use super::extent::decades;
use crate::plot::chart::{Axes, log_figure};
use crate::plot::drawing::Drawn;
use crate::plot::palette::{BLUE, VERMILLION};
use cloth_study::level::levels;
use cloth_study::study::Study;
use plotters::style::Color;

/// # Errors
/// No fit to noise.
pub(super) fn draw(study: &Study) -> Drawn<String> {
    let levels = levels(study);
    let noises = decades(levels.iter().map(|level| level.noise)).ok_or("no noise")?;
    let errors = levels.iter().flat_map(|level| [Some(level.error), level.floor]).flatten();
    let errors = decades(errors).ok_or("no errors")?;
    let axes = Axes {
        title: "Curve error against noise",
        x: ("noise, multiple of the instruments'", noises),
        y: ("curve error, share of the largest stress", errors),
    };
    log_figure(axes, |chart| {
        let groups: Vec<_> = levels.chunk_by(|a, b| a.test == b.test).collect();
        for (index, group) in groups.iter().enumerate() {
            // Two meshes per curve: the fit's own first.
            let colour = if index < 2 { BLUE } else { VERMILLION };
            let own = index % 2 == 0;
            let style = if own { colour.filled() } else { colour.stroke_width(3) };
            let points = || group.iter().map(|level| (level.noise, level.error));
            chart.paths([points().collect()], colour.stroke_width(3), "");
            chart.dots(points(), (8, style), &group[0].test);
            if own {
                let floor = group.iter().filter_map(|level| Some((level.noise, level.floor?)));
                let curve = group[0].test.split(',').next().unwrap_or_default();
                chart.dashes(floor, colour.stroke_width(3), &format!("{curve}, floor"));
            }
        }
    })
}
