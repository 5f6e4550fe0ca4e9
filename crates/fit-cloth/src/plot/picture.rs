//! Views of sheets side by side at the same scale, without perspective.

use super::drawing::{Area, Drawn};
use super::painter::{Painter, Panel, draw_arrow};
use super::view::View;
use super::writing::{self, INK, TEXT, TITLE};
use nalgebra::Vector3;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

/// Minimum and maximum height of a panel, in pixels: twice the displayed size.
const HEIGHTS: [f64; 2] = [360.0, 760.0];
/// Margin around the sheet in a panel.
const MARGIN: f64 = 36.0;
/// Heights of the main title, of the panel titles, and of the scales below.
const HEAD: f64 = 64.0;
const NAME: f64 = 64.0;
const FOOT: f64 = 76.0;

/// Minimum and maximum length of the scale arrow, in pixels, before rounding its value.
const LENGTHS: [f64; 2] = [80.0, 240.0];

/// One view of a sheet.
pub(super) struct Picture<'p> {
    pub(super) title: String,
    pub(super) view: View,
    /// Points that must be visible, m; non-finite points are ignored.
    pub(super) points: Vec<Vector3<f64>>,
    pub(super) paint: Box<dyn Fn(&mut Painter<'_>) + 'p>,
}

/// Scale of the arrows in the pictures; a scale arrow of a round value is drawn below.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArrowScale {
    /// Length of a unit, m.
    pub(super) metres: f64,
    pub(super) unit: &'static str,
    pub(super) style: ShapeStyle,
    /// Name and largest value of the quantity.
    pub(super) name: &'static str,
    pub(super) largest: f64,
}

/// Draws pictures side by side.
///
/// * `title` — above all panels; "" for none
/// * `width` — of each panel, in pixels
///
/// # Errors
/// Sheets without extent.
pub(super) fn draw(
    title: &str,
    width: f64,
    pictures: &[Picture<'_>],
    arrows: Option<ArrowScale>,
) -> Drawn<String> {
    let seen: Vec<_> = pictures.iter().map(|picture| picture.view.extent(&picture.points)).collect();
    let size = |axis: usize| seen.iter().map(|[low, high]| high[axis] - low[axis]).fold(0.0, f64::max);
    let inner = width - 2.0 * MARGIN;
    let height = (inner * size(1) / size(0) + 2.0 * MARGIN).clamp(HEIGHTS[0], HEIGHTS[1]);
    let scale = (inner / size(0)).min((height - 2.0 * MARGIN) / size(1));
    if !(scale > 0.0 && scale.is_finite()) {
        return Err("a sheet without extent".into());
    }
    let head = if title.is_empty() { 0.0 } else { HEAD };
    let mut figure = String::new();
    {
        let total = [width * pictures.len() as f64, head + NAME + height + FOOT];
        let total = total.map(|length| length.ceil() as u32);
        let area = SVGBackend::with_string(&mut figure, total.into()).into_drawing_area();
        area.fill(&WHITE)?;
        if !title.is_empty() {
            let (most, at) = (total[0] as i32 - 2 * MARGIN as i32, (MARGIN as i32, (0.5 * head) as i32 + 6));
            writing::write_within(&area, most, title, at, (TITLE, HPos::Left, INK))?;
        }
        for (index, (picture, [low, high])) in pictures.iter().zip(seen).enumerate() {
            let middle = [width * (index as f64 + 0.5), head + NAME + 0.5 * height];
            let panel = Panel { scale, middle, centre: [0, 1].map(|axis| 0.5 * (low[axis] + high[axis])) };
            let at = (middle[0] as i32, (head + 0.5 * NAME) as i32);
            writing::write_within(&area, inner as i32, &picture.title, at, (TEXT, HPos::Center, INK))?;
            let mut painter = Painter::new(&picture.view, panel);
            (picture.paint)(&mut painter);
            painter.draw(&area)?;
        }
        let y = head + NAME + height + 0.5 * FOOT;
        let end = scale_bar(&area, 0.3 * width / scale, scale, y)?;
        if let Some(arrows) = arrows {
            arrow_scale(&area, arrows, scale, [f64::from(end) + 2.0 * MARGIN, y])?;
        }
        area.present()?;
    }
    // Opaque is the default; with thousands of faces this saves a sixth of the file.
    Ok(figure.replace(" opacity=\"1\"", ""))
}

/// Draws a scale bar of a round length near `about` metres; returns the end of its label, in pixels.
fn scale_bar(area: &Area<'_>, about: f64, scale: f64, y: f64) -> Drawn<i32> {
    let length = round_below(about);
    let name = if length < 1.0 { number(1e3 * length, "mm") } else { number(length, "m") };
    let [from, to] = [MARGIN, MARGIN + length * scale].map(|x| x.round() as i32);
    let y = y as i32;
    let line = |points: Vec<(i32, i32)>| PathElement::new(points, INK.stroke_width(3));
    area.draw(&line(vec![(from, y), (to, y)]))?;
    for x in [from, to] {
        area.draw(&line(vec![(x, y - 8), (x, y + 8)]))?;
    }
    writing::write(area, &name, (to + 16, y), (TEXT, HPos::Left, INK))?;
    Ok(to + 16 + writing::width(&name, TEXT))
}

/// Draws a scale arrow of a round value, near the largest unless that is too short or too long.
fn arrow_scale(area: &Area<'_>, arrows: ArrowScale, scale: f64, [x, y]: [f64; 2]) -> Drawn<()> {
    let unit = 1.0 / (arrows.metres * scale);
    let value = round_below(arrows.largest.clamp(LENGTHS[0] * unit, LENGTHS[1] * unit));
    let to = x + value * arrows.metres * scale;
    draw_arrow(area, [[x, y], [to, y]], arrows.style)?;
    let text = format!("{}: {}", arrows.name, number(value, arrows.unit));
    writing::write(area, &text, (to as i32 + 16, y as i32), (TEXT, HPos::Left, INK))
}

/// The largest of 1, 2 or 5 times a power of ten that does not exceed a value.
fn round_below(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|n| n * decade).find(|round| *round <= value).unwrap_or(decade)
}

/// Formats a round number with its unit.
fn number(value: f64, unit: &str) -> String {
    let decimals = (-value.log10().floor()).max(0.0) as usize;
    format!("{value:.decimals$} {unit}")
}
