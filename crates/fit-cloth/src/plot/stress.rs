//! Stress against strain, with its 95 % band and the control points.

use super::{Drawing, MODEL, SIZE};
use cloth_fit::report::StageReport;
use plotters::prelude::*;

pub(super) fn draw(stage: &StageReport) -> Drawing {
    let samples = &stage.curve.samples;
    let [low, high] = stage.curve.visited;
    let highest = |sample: &cloth_fit::report::Sample| sample.band.map_or(sample.stress, |[_, high]| high);
    let top = samples.iter().map(highest).fold(0.0, f64::max);
    let bottom = samples.iter().map(|sample| sample.stress).fold(0.0, f64::min);
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let mut chart = ChartBuilder::on(&area)
            .caption(format!("{}, {}", stage.name(), stage.model), ("sans-serif", 36))
            .margin(28)
            .x_label_area_size(88)
            .y_label_area_size(128)
            .build_cartesian_2d(low..high * 1.03, bottom..top * 1.06)?;
        chart
            .configure_mesh()
            .x_desc("strain")
            .y_desc("stress [N/m]")
            .light_line_style(WHITE)
            .label_style(("sans-serif", 28))
            .draw()?;
        let upper = samples.iter().filter_map(|s| s.band.map(|[_, high]| (s.strain, high)));
        let lower = samples.iter().rev().filter_map(|s| s.band.map(|[low, _]| (s.strain, low)));
        chart.draw_series(std::iter::once(Polygon::new(
            upper.chain(lower).collect::<Vec<_>>(),
            MODEL.mix(0.22),
        )))?;
        chart
            .draw_series(LineSeries::new(
                samples.iter().map(|s| (s.strain, s.stress)),
                MODEL.stroke_width(4),
            ))?
            .label("fit, 95 % band")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 36, y)], MODEL.stroke_width(4)));
        let curve = &stage.curve.curve;
        let points = curve.strains().iter().zip(curve.stiffnesses()).map(|(&strain, k)| (strain, k * strain));
        chart
            .draw_series(points.map(|point| Circle::new(point, 8, MODEL.filled())))?
            .label("control points")
            .legend(|(x, y)| Circle::new((x + 18, y), 8, MODEL.filled()));
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
