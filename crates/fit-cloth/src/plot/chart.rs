//! What all figures have in common: paper, axes, legend.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;

/// Size of a figure: twice what it is shown at, since lines are drawn through whole pixels.
const SIZE: (u32, u32) = (1280, 840);

/// What a drawing may fail with.
pub(super) type Drawn<T> = Result<T, Box<dyn Error>>;

type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Axes with their names and extents.
pub(super) struct Axes<'t> {
    pub(super) title: &'t str,
    pub(super) x: (&'t str, Range<f64>),
    pub(super) y: (&'t str, Range<f64>),
}

/// A figure in the making.
pub(super) struct Chart<'a, 'b: 'a>(Context<'a, 'b>);

/// Draws a figure.
///
/// # Errors
/// Extents that no axis can have.
pub(super) fn figure(axes: Axes<'_>, series: impl FnOnce(&mut Chart<'_, '_>) -> Drawn<()>) -> Drawn<String> {
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let context = ChartBuilder::on(&area)
            .caption(axes.title, ("sans-serif", 36))
            .margin(28)
            .x_label_area_size(88)
            .y_label_area_size(150)
            .build_cartesian_2d(axes.x.1, axes.y.1.clone())?;
        let mut chart = Chart(context);
        chart.mesh(axes.x.0, axes.y.0, axes.y.1)?;
        series(&mut chart)?;
        chart.legend()?;
        area.present()?;
    }
    Ok(figure)
}

impl<'a, 'b: 'a> Chart<'a, 'b> {
    fn mesh(&mut self, x: &str, y: &str, extent: Range<f64>) -> Drawn<()> {
        let largest = extent.start.abs().max(extent.end.abs());
        // Moments are small numbers.
        let small = |value: &f64| if *value == 0.0 { "0".into() } else { format!("{value:.1e}") };
        let mut mesh = self.0.configure_mesh();
        mesh.x_desc(x).y_desc(y).light_line_style(WHITE).label_style(("sans-serif", 28));
        if largest < 1e-2 {
            mesh.y_label_formatter(&small);
        }
        Ok(mesh.draw()?)
    }

    fn legend(&mut self) -> Drawn<()> {
        self.0
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .legend_area_size(60)
            .label_font(("sans-serif", 28))
            .background_style(WHITE.mix(0.8))
            .draw()?;
        Ok(())
    }

    /// An area, without an entry in the legend.
    pub(super) fn band(&mut self, outline: Vec<(f64, f64)>, colour: RGBColor) -> Drawn<()> {
        self.0.draw_series(std::iter::once(Polygon::new(outline, colour.mix(0.22))))?;
        Ok(())
    }

    /// A line through points in order; it is broken where the number of one is not that after the last.
    pub(super) fn line(
        &mut self,
        points: impl IntoIterator<Item = (usize, f64, f64)>,
        colour: RGBColor,
        label: &str,
    ) -> Drawn<()> {
        let style = colour.stroke_width(4);
        let points: Vec<_> = points.into_iter().collect();
        // Sequences of one kind follow one another, each from its first frame.
        let pieces = points.chunk_by(|a, b| b.0 == a.0 + 1);
        let pieces = pieces.map(|piece| piece.iter().map(|&(_, x, y)| (x, y)).collect::<Vec<_>>());
        let pieces = pieces.map(|piece| PathElement::new(piece, style));
        self.0
            .draw_series(pieces)?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 36, y)], style));
        Ok(())
    }

    /// Dots of a style.
    pub(super) fn dots(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        (size, style): (i32, ShapeStyle),
        label: &str,
    ) -> Drawn<()> {
        self.0
            .draw_series(points.into_iter().map(|point| Circle::new(point, size, style)))?
            .label(label)
            .legend(move |(x, y)| Circle::new((x + 18, y), size, style));
        Ok(())
    }
}
