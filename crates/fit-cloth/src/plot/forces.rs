//! Force against extension: measured on loading and unloading, and the model, one clip a sequence.

use super::{Drawing, LOADING, MODEL, SIZE, UNLOADING};
use cloth_fit::frame::Phase;
use cloth_fit::report::{ForceRow, StageReport};
use plotters::prelude::*;

pub(super) fn draw(stage: &StageReport) -> Drawing {
    let rows: Vec<&ForceRow> = stage.sequences.iter().flat_map(|s| pulled_rows(&s.forces)).collect();
    let widest = rows.iter().map(|row| row.extension).fold(0.0, f64::max);
    let highest = rows.iter().map(|row| row.measured.abs()).fold(0.0, f64::max);
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(format!("{}, {}", stage.name(), stage.model), ("sans-serif", 36))
            .margin(28)
            .x_label_area_size(88)
            .y_label_area_size(128)
            .build_cartesian_2d(0.0..widest * 1.03, 0.0..highest * 1.06)?;
        chart
            .configure_mesh()
            .x_desc("extension")
            .y_desc("clip force [N]")
            .light_line_style(WHITE)
            .label_style(("sans-serif", 28))
            .draw()?;
        let mut simulated: Vec<(f64, f64)> =
            rows.iter().map(|row| (row.extension, row.simulated.abs())).collect();
        simulated.sort_by(|a, b| a.0.total_cmp(&b.0));
        chart
            .draw_series(LineSeries::new(simulated, MODEL.stroke_width(4)))?
            .label("model")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 36, y)], MODEL.stroke_width(4)));
        for (unloading, label, colour) in
            [(false, "measured, loading", LOADING), (true, "measured, unloading", UNLOADING)]
        {
            let branch: Vec<_> =
                rows.iter().filter(|row| (row.phase == Phase::Unloading) == unloading).collect();
            if branch.is_empty() {
                continue;
            }
            chart
                .draw_series(
                    branch.iter().map(|row| {
                        Circle::new((row.extension, row.measured.abs()), 6, colour.stroke_width(2))
                    }),
                )?
                .label(label)
                .legend(move |(x, y)| Circle::new((x + 18, y), 6, colour.stroke_width(2)));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .legend_area_size(60)
            .label_font(("sans-serif", 28))
            .background_style(WHITE.mix(0.8))
            .draw()?;
        area.present()?;
    }
    Ok(figure)
}

/// The rows of the force component that is largest: the pull, on the clip where it was measured.
fn pulled_rows(rows: &[ForceRow]) -> Vec<&ForceRow> {
    let largest = rows.iter().max_by(|a, b| a.measured.abs().total_cmp(&b.measured.abs()));
    let same = |row: &&ForceRow| largest.is_some_and(|l| row.clip == l.clip && row.direction == l.direction);
    rows.iter().filter(same).collect()
}
