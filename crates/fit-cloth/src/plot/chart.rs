//! What all figures have in common: paper, axes, legend.

use plotters::coord::combinators::LogCoord;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use std::error::Error;
use std::ops::Range;

/// Size of a figure: twice what it is shown at, since lines are drawn through whole pixels.
const SIZE: (u32, u32) = (1280, 840);

/// What a drawing may fail with.
pub(super) type Drawn<T> = Result<T, Box<dyn Error>>;

type Context<'a, 'b, X> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, X>>;

/// How the numbers along an axis are told.
type Label<'l> = &'l dyn Fn(&f64) -> String;

/// Axes with their names and extents.
pub(super) struct Axes<'t> {
    pub(super) title: &'t str,
    pub(super) x: (&'t str, Range<f64>),
    pub(super) y: (&'t str, Range<f64>),
}

/// A figure in the making; both its axes are of one kind.
pub(super) struct Chart<'a, 'b: 'a, X: Ranged<ValueType = f64> = RangedCoordf64>(Context<'a, 'b, X>);

/// One with logarithmic axes.
pub(super) type LogChart<'a, 'b> = Chart<'a, 'b, LogCoord<f64>>;

/// Draws a figure.
///
/// # Errors
/// Extents that no axis can have.
pub(super) fn figure(axes: Axes<'_>, series: impl FnOnce(&mut Chart<'_, '_>) -> Drawn<()>) -> Drawn<String> {
    let largest = axes.y.1.start.abs().max(axes.y.1.end.abs());
    // Moments are small numbers.
    let small = |value: &f64| if *value == 0.0 { "0".into() } else { format!("{value:.1e}") };
    let label: Option<Label<'_>> = if largest < 1e-2 { Some(&small) } else { None };
    let (x, y) = (axes.x.1.clone(), axes.y.1.clone());
    draw(&axes, [x, y], [None, label], SeriesLabelPosition::UpperLeft, series)
}

/// Draws a figure with logarithmic axes; the legend has its place above right.
///
/// # Errors
/// Extents that no such axis can have.
pub(super) fn log_figure(
    axes: Axes<'_>,
    series: impl FnOnce(&mut LogChart<'_, '_>) -> Drawn<()>,
) -> Drawn<String> {
    // Of every decade 1, 2 and 5.
    let power = |value: &f64| match value.abs() {
        size if !['1', '2', '5'].contains(&format!("{size:e}").chars().next().unwrap_or(' ')) => {
            String::new()
        }
        size if (1e-3..1e4).contains(&size) => format!("{value}"),
        _ => format!("{value:e}"),
    };
    let (x, y) = (axes.x.1.clone().log_scale(), axes.y.1.clone().log_scale());
    draw(&axes, [x, y], [Some(&power), Some(&power)], SeriesLabelPosition::UpperRight, series)
}

fn draw<X, R>(
    axes: &Axes<'_>,
    extents: [R; 2],
    labels: [Option<Label<'_>>; 2],
    legend: SeriesLabelPosition,
    series: impl FnOnce(&mut Chart<'_, '_, X>) -> Drawn<()>,
) -> Drawn<String>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    R: AsRangedCoord<CoordDescType = X, Value = f64>,
{
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, SIZE).into_drawing_area();
        area.fill(&WHITE)?;
        let [x, y] = extents;
        let context = ChartBuilder::on(&area)
            .caption(axes.title, ("sans-serif", 36))
            .margin(28)
            .x_label_area_size(88)
            .y_label_area_size(150)
            .build_cartesian_2d(x, y)?;
        let mut chart = Chart(context);
        chart.mesh([axes.x.0, axes.y.0], labels)?;
        series(&mut chart)?;
        chart.legend(legend)?;
        area.present()?;
    }
    Ok(figure)
}

impl<'a, 'b: 'a, X: Ranged<ValueType = f64> + ValueFormatter<f64>> Chart<'a, 'b, X> {
    fn mesh(&mut self, names: [&str; 2], labels: [Option<Label<'_>>; 2]) -> Drawn<()> {
        let mut mesh = self.0.configure_mesh();
        mesh.x_desc(names[0]).y_desc(names[1]).light_line_style(WHITE).label_style(("sans-serif", 28));
        if let Some(label) = labels[0] {
            mesh.x_label_formatter(label);
        }
        if let Some(label) = labels[1] {
            mesh.y_label_formatter(label);
        }
        Ok(mesh.draw()?)
    }

    fn legend(&mut self, position: SeriesLabelPosition) -> Drawn<()> {
        self.0
            .configure_series_labels()
            .position(position)
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

    /// A thin line through points in order, without an entry in the legend: that of its dots says what it is.
    pub(super) fn path(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        colour: RGBColor,
    ) -> Drawn<()> {
        let points: Vec<_> = points.into_iter().collect();
        self.0.draw_series(std::iter::once(PathElement::new(points, colour.stroke_width(3))))?;
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

    /// A broken line through points in order.
    pub(super) fn dashes(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: ShapeStyle,
        label: &str,
    ) -> Drawn<()> {
        let points: Vec<_> = points.into_iter().collect();
        self.0
            .draw_series(DashedLineSeries::new(points, 12, 10, style))?
            .label(label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 36, y)], style));
        Ok(())
    }

    /// Crosses.
    pub(super) fn crosses(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: ShapeStyle,
        label: &str,
    ) -> Drawn<()> {
        self.0
            .draw_series(points.into_iter().map(|point| Cross::new(point, 10, style)))?
            .label(label)
            .legend(move |(x, y)| Cross::new((x + 18, y), 10, style));
        Ok(())
    }
}
