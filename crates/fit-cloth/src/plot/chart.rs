//! Common parts of figures with axes: background, axes, legend.

use super::drawing::{Area, Drawn};
use super::series::{self, Mark, Series};
use super::writing::{self, INK, TEXT, TITLE, signed};
use plotters::coord::combinators::{LogCoord, WithKeyPoints};
use plotters::coord::ranged1d::{AsRangedCoord, BoldPoints, Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use std::ops::Range;

/// Size of a figure in pixels: twice the displayed size, since lines are drawn at whole pixels.
const SIZE: (u32, u32) = (1280, 840);
/// Size of a figure with two panels.
const TALL: (u32, u32) = (1280, 960);
/// Margins; the right one has room for half a number beyond the end of the axis.
const MARGIN: i32 = 28;
const RIGHT: i32 = 56;
/// Room for the numbers and names of the axes.
const BELOW: i32 = 88;
const BESIDE: i32 = 150;
/// Length of tick marks; numbers begin at twice this distance.
const TICK: i32 = 8;
/// Maximum numbers along each axis.
const NUMBERS: [usize; 2] = [9, 7];
/// Share of a figure's height for the lower panel and its axis.
const BENEATH: f64 = 0.42;
/// Minimum width of the plot area of figures to scale, in pixels.
const NARROWEST: f64 = 560.0;

/// Formatter of the numbers along an axis.
type Label<'l> = Box<dyn Fn(&f64) -> String + 'l>;

/// Title, and names and extents of the axes.
pub(super) struct Axes<'t> {
    pub(super) title: &'t str,
    pub(super) x: (&'t str, Range<f64>),
    pub(super) y: (&'t str, Range<f64>),
}

/// Series to draw, bottom first.
#[derive(Default)]
pub(super) struct Chart(Vec<Series>);

/// Draws a figure.
///
/// # Errors
/// Invalid extents of an axis.
pub(super) fn figure(axes: Axes<'_>, fill: impl FnOnce(&mut Chart)) -> Drawn<String> {
    let chart = Chart::filled(fill);
    draw(axes.title, SIZE, &[&chart], |area| linear(area, axes.x, axes.y, BELOW, &chart))
}

/// Draws a figure with the same scale along both axes.
///
/// # Errors
/// As [`figure`].
pub(super) fn figure_to_scale(axes: Axes<'_>, fill: impl FnOnce(&mut Chart)) -> Drawn<String> {
    let chart = Chart::filled(fill);
    let (mut x, mut y) = (axes.x, axes.y);
    let length = |extent: &Range<f64>| extent.end - extent.start;
    // Of standard height, and as wide as the scale requires; assumes a legend of one row.
    let beside = BESIDE + MARGIN + RIGHT;
    let most = f64::from(SIZE.0 as i32 - beside);
    let inner = SIZE.1 as i32 - BELOW - MARGIN - MARGIN / 2 - 2 * MARGIN - TITLE - series::ROW;
    let wide = (f64::from(inner) * length(&x.1) / length(&y.1)).clamp(NARROWEST, most);
    let size = (wide as u32 + beside as u32, SIZE.1);
    let pixel = (length(&x.1) / wide).max(length(&y.1) / f64::from(inner));
    for (extent, pixels) in [(&mut x.1, wide), (&mut y.1, f64::from(inner))] {
        let more = 0.5 * (pixel * pixels - length(extent));
        *extent = extent.start - more..extent.end + more;
    }
    draw(axes.title, size, &[&chart], |area| linear(area, x, y, BELOW, &chart))
}

/// Draws a figure of two panels, one above the other, over the same x.
///
/// # Errors
/// As [`figure`].
pub(super) fn figure_over(
    axes: Axes<'_>,
    fill: impl FnOnce(&mut Chart),
    beneath: (&str, Range<f64>),
    fill_beneath: impl FnOnce(&mut Chart),
) -> Drawn<String> {
    let charts = [Chart::filled(fill), Chart::filled(fill_beneath)];
    draw(axes.title, TALL, &[&charts[0], &charts[1]], |area| {
        let (_, high) = area.dim_in_pixel();
        let (upper, lower) = area.split_vertically((f64::from(high) * (1.0 - BENEATH)) as i32);
        // Only the lower panel has numbers along x.
        linear(&upper, ("", axes.x.1.clone()), axes.y, 0, &charts[0])?;
        linear(&lower, axes.x, beneath, BELOW, &charts[1])
    })
}

/// Draws a figure with logarithmic axes.
///
/// # Errors
/// Invalid extents of a logarithmic axis.
pub(super) fn log_figure(axes: Axes<'_>, fill: impl FnOnce(&mut Chart)) -> Drawn<String> {
    let chart = Chart::filled(fill);
    draw(axes.title, SIZE, &[&chart], |area| {
        let extents = (decades(axes.x.1), decades(axes.y.1));
        between(area, extents, [axes.x.0, axes.y.0], [Box::new(power), Box::new(power)], BELOW, &chart)
    })
}

/// Draws a figure with a logarithmic y axis.
///
/// # Errors
/// Invalid extents of a logarithmic axis.
pub(super) fn half_log_figure(axes: Axes<'_>, fill: impl FnOnce(&mut Chart)) -> Drawn<String> {
    let chart = Chart::filled(fill);
    draw(axes.title, SIZE, &[&chart], |area| {
        let labels = [numbers(&axes.x.1, NUMBERS[0]), Box::new(power)];
        let extents = (axes.x.1, decades(axes.y.1));
        between(area, extents, [axes.x.0, axes.y.0], labels, BELOW, &chart)
    })
}

/// Draws linear axes and a chart.
///
/// * `below` — height for the numbers and name of x, in pixels; 0 for none
fn linear(
    area: &Area<'_>,
    x: (&str, Range<f64>),
    y: (&str, Range<f64>),
    below: i32,
    chart: &Chart,
) -> Drawn<()> {
    let labels = [numbers(&x.1, NUMBERS[0]), numbers(&y.1, NUMBERS[1])];
    between(area, (x.1, y.1), [x.0, y.0], labels, below, chart)
}

/// Draws background, title and legend; `rest` draws on the remaining area.
fn draw(
    title: &str,
    size: (u32, u32),
    charts: &[&Chart],
    rest: impl FnOnce(&Area<'_>) -> Drawn<()>,
) -> Drawn<String> {
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, size).into_drawing_area();
        area.fill(&WHITE)?;
        let wide = size.0 as i32 - 2 * MARGIN;
        writing::write_within(&area, wide, title, (MARGIN, MARGIN + TITLE / 2), (TITLE, HPos::Left, INK))?;
        let named: Vec<&Series> = charts.iter().flat_map(|chart| &chart.0).collect();
        let from = (MARGIN, 2 * MARGIN + TITLE);
        let rows = series::legend(&area, &named, from, size.0 as i32 - MARGIN)?;
        let (_, below) = area.split_vertically(from.1 + rows);
        rest(&below)?;
        area.present()?;
    }
    // Opaque is the default.
    Ok(figure.replace(" opacity=\"1\"", ""))
}

/// Draws axes of any kind and a chart.
fn between<R, S, X, Y>(
    area: &Area<'_>,
    (x, y): (R, S),
    [x_name, y_name]: [&str; 2],
    [x_label, y_label]: [Label<'_>; 2],
    below: i32,
    chart: &Chart,
) -> Drawn<()>
where
    R: AsRangedCoord<CoordDescType = X, Value = f64>,
    S: AsRangedCoord<CoordDescType = Y, Value = f64>,
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut context = ChartBuilder::on(area)
        .margin(MARGIN)
        .margin_right(RIGHT)
        .margin_bottom(if below > 0 { MARGIN / 2 } else { 0 })
        .x_label_area_size(below)
        .y_label_area_size(BESIDE)
        .build_cartesian_2d(x, y)?;
    let mut mesh = context.configure_mesh();
    mesh.x_desc(x_name).y_desc(y_name).x_label_formatter(&x_label).y_label_formatter(&y_label);
    mesh.x_labels(NUMBERS[0]).y_labels(NUMBERS[1]).light_line_style(WHITE);
    // Longer ticks below: the numbers of both axes meet in the corner.
    mesh.set_tick_mark_size(LabelAreaPosition::Bottom, TICK);
    mesh.label_style(("sans-serif", TEXT).into_font().color(&INK)).draw()?;
    chart.0.iter().try_for_each(|series| series.draw(&mut context))
}

/// Formats with as many decimals as distinguish the numbers; in scientific notation if very small or large.
fn numbers(extent: &Range<f64>, at_most: usize) -> Label<'static> {
    let largest = extent.start.abs().max(extent.end.abs());
    if !(1e-3..1e6).contains(&largest) {
        return Box::new(|value| if *value == 0.0 { "0".into() } else { signed(format!("{value:.1e}")) });
    }
    let marks = RangedCoordf64::from(extent.clone()).key_points(BoldPoints(at_most));
    let told = |decimals: &i32| {
        let unit = 10f64.powi(*decimals);
        marks.iter().all(|mark| (mark * unit - (mark * unit).round()).abs() < 1e-6 * largest * unit)
    };
    let decimals = (0..9).find(told).unwrap_or(9) as usize;
    // A value that rounds to zero has no sign.
    Box::new(move |value| {
        let value = if value.abs() < 1e-9 * largest { 0.0 } else { *value };
        signed(format!("{value:.decimals$}"))
    })
}

/// A logarithmic axis with ticks at 1, 2 and 5 over up to three decades, else at powers of ten.
fn decades(extent: Range<f64>) -> WithKeyPoints<LogCoord<f64>> {
    let [from, to] = [extent.start.log10().floor(), extent.end.log10().ceil()].map(|power| power as i32);
    let steps: &[f64] = if extent.end < 1e3 * extent.start { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let marks = (from..=to).flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)));
    let marks = marks.filter(|mark| extent.contains(mark)).collect();
    extent.log_scale().with_key_points(marks)
}

/// Formats a round number, in scientific notation if very small or large.
fn power(value: &f64) -> String {
    match value.abs() {
        // The computed 2 · 10⁻³ may have rounding errors in the last digits.
        size if (1e-3..1e4).contains(&size) => format!("{}", (value * 1e9).round() / 1e9),
        _ => signed(format!("{value:.0e}")),
    }
}

impl Chart {
    fn filled(fill: impl FnOnce(&mut Self)) -> Self {
        let mut chart = Self::default();
        fill(&mut chart);
        chart
    }

    fn add(&mut self, mark: Mark, pieces: impl IntoIterator<Item = Vec<(f64, f64)>>, label: &str) {
        let series = Series::new(mark, pieces, label);
        // Empty series do not appear in the legend.
        self.0.extend(series.is_drawn().then_some(series));
    }

    /// Adds filled polygons.
    pub(super) fn areas(
        &mut self,
        outlines: impl IntoIterator<Item = Vec<(f64, f64)>>,
        colour: RGBAColor,
        label: &str,
    ) {
        self.add(Mark::Areas(colour), outlines, label);
    }

    /// Adds a line through numbered points; it is interrupted where the numbers are not consecutive.
    pub(super) fn line(
        &mut self,
        points: impl IntoIterator<Item = (usize, f64, f64)>,
        style: ShapeStyle,
        label: &str,
    ) {
        let points: Vec<_> = points.into_iter().collect();
        // Sequences of one kind follow each other; each starts at its first frame.
        let pieces = points.chunk_by(|a, b| b.0 == a.0 + 1);
        self.add(
            Mark::Line(style),
            pieces.map(|piece| piece.iter().map(|&(_, x, y)| (x, y)).collect()),
            label,
        );
    }

    /// Adds a line per piece; without a label, they share the legend entry of their dots.
    pub(super) fn paths(
        &mut self,
        pieces: impl IntoIterator<Item = Vec<(f64, f64)>>,
        style: ShapeStyle,
        label: &str,
    ) {
        self.add(Mark::Line(style), pieces, label);
    }

    /// Adds dots of a size and style.
    pub(super) fn dots(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        (size, style): (i32, ShapeStyle),
        label: &str,
    ) {
        self.add(Mark::Dots(size, style), [points.into_iter().collect()], label);
    }

    /// Adds a dashed line.
    pub(super) fn dashes(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: ShapeStyle,
        label: &str,
    ) {
        self.add(Mark::Dashes(style), [points.into_iter().collect()], label);
    }

    /// Adds crosses.
    pub(super) fn crosses(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: ShapeStyle,
        label: &str,
    ) {
        self.add(Mark::Crosses(style), [points.into_iter().collect()], label);
    }
}
