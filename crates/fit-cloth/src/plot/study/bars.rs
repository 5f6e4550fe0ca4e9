//! Horizontal bars with names on the left and notes on the right.

use crate::plot::drawing::Drawn;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Widths of the names and of the bars with their notes, and height of a row, in pixels.
const NAMES: u32 = 640;
const BARS: u32 = 900;
const ROW: u32 = 52;

/// Space above and below the rows, in pixels.
const ABOVE: u32 = 150;
const BELOW: u32 = 110;

/// One bar, of one or several pieces end to end.
pub(super) struct Bar {
    pub(super) name: String,
    pub(super) pieces: Vec<(f64, RGBColor)>,
    pub(super) note: String,
}

/// Draws bars from top to bottom, with a legend of colours below the title.
///
/// # Errors
/// No bar, or an invalid extent.
pub(super) fn draw(
    title: &str,
    x: (&str, Range<f64>),
    legend: &[(&str, RGBColor)],
    bars: &[Bar],
) -> Drawn<String> {
    if bars.is_empty() {
        return Err("no bars".into());
    }
    let height = ABOVE + BELOW + ROW * bars.len() as u32;
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, (NAMES + BARS, height)).into_drawing_area();
        area.fill(&WHITE)?;
        let text = ("sans-serif", 28).into_font().color(&BLACK);
        area.draw(&Text::new(title, (28, 28), ("sans-serif", 36).into_font().color(&BLACK)))?;
        let mut at = 28;
        for (name, colour) in legend {
            area.draw(&Rectangle::new([(at, 88), (at + 28, 116)], colour.filled()))?;
            area.draw(&Text::new(*name, (at + 40, 88), text.clone()))?;
            at += 70 + 15 * name.len() as i32;
        }
        let (_, right) = area.split_horizontally(NAMES);
        let rows = bars.len() as f64;
        let mut chart = ChartBuilder::on(&right)
            .margin_top(ABOVE)
            .margin_right(40)
            .margin_bottom(14)
            .x_label_area_size(BELOW - 14)
            .build_cartesian_2d(x.1, rows..0.0)?;
        let mut mesh = chart.configure_mesh();
        mesh.disable_y_axis().disable_y_mesh().x_desc(x.0).light_line_style(WHITE);
        mesh.x_label_formatter(&|value| format!("{value}")).label_style(("sans-serif", 28)).draw()?;
        for (row, bar) in bars.iter().enumerate() {
            let middle = row as f64 + 0.5;
            let mut from = 0.0;
            for (length, colour) in &bar.pieces {
                let corners = [(from, middle - 0.33), (from + length, middle + 0.33)];
                chart.draw_series([Rectangle::new(corners, colour.filled())])?;
                from += length;
            }
            let [_, y] = <[i32; 2]>::from(chart.backend_coord(&(0.0, middle)));
            let [end, _] = <[i32; 2]>::from(chart.backend_coord(&(from.max(0.0), middle)));
            let right = text.clone().pos(Pos::new(HPos::Right, VPos::Center));
            let left = text.clone().pos(Pos::new(HPos::Left, VPos::Center));
            area.draw(&Text::new(bar.name.clone(), (NAMES as i32 - 20, y), right))?;
            area.draw(&Text::new(bar.note.clone(), (end + 12, y), left))?;
        }
        area.present()?;
    }
    Ok(figure)
}
