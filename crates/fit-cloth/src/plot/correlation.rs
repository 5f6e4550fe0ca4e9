//! Correlation of control values, one block per curve.

use super::drawing::{Area, Drawn};
use super::palette::{BLUE, GREY, VERMILLION};
use super::writing::{self, INK, TEXT, TITLE, signed};
use cloth_fit::incremental::FitReport;
use cloth_fit::stage::report::StageReport;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

const MARGIN: i32 = 28;
/// Blocks in a row, and the minimum size of a block, in pixels.
const COLUMNS: usize = 3;
const LEAST: i32 = 400;
/// Side of a cell, and the space for numbers and between blocks, in pixels.
const CELL: i32 = 76;
const NUMBERS: i32 = 48;
const NAME: i32 = 44;
const GAP: i32 = 44;
/// Height and number of steps of the colour scale below.
const SCALE: i32 = 24;
const STEPS: i32 = 20;
const BELOW: i32 = 150;
const NAME_OF_SCALE: &str = "correlation [–]; rows and columns: control points from the smallest strain";
/// Colour of a cell without data.
const UNKNOWN: RGBColor = RGBColor(225, 225, 225);

/// # Errors
/// No curve with several control values.
pub(super) fn draw(report: &FitReport) -> Drawn<String> {
    let stages: Vec<&StageReport> = report.last_stages().filter(|stage| stage.curve.observed).collect();
    let most = |stages: &[&StageReport]| stages.iter().map(|s| s.curve.correlations.len()).max().unwrap_or(0);
    if most(&stages) == 0 {
        return Err("no curves".into());
    }
    let block = (NUMBERS + CELL * most(&stages) as i32).max(LEAST);
    let columns = stages.len().min(COLUMNS) as i32;
    // Top of each row of blocks, and the bottom of the last.
    let mut tops = vec![2 * MARGIN + TITLE];
    for row in stages.chunks(COLUMNS) {
        tops.push(tops[tops.len() - 1] + NAME + NUMBERS + CELL * most(row) as i32 + GAP);
    }
    let bottom = tops[tops.len() - 1];
    let wide = 2 * MARGIN + columns * block + (columns - 1) * GAP;
    let title = format!("Correlation of control values, {}", report.model);
    let wide = wide.max(2 * MARGIN + writing::width(&title, TITLE).max(writing::width(NAME_OF_SCALE, TEXT)));
    let size = (wide, bottom + BELOW);
    let mut figure = String::new();
    {
        let area = SVGBackend::with_string(&mut figure, (size.0 as u32, size.1 as u32)).into_drawing_area();
        area.fill(&WHITE)?;
        writing::write(&area, &title, (MARGIN, MARGIN + TITLE / 2), (TITLE, HPos::Left, INK))?;
        for (index, stage) in stages.iter().enumerate() {
            let left = MARGIN + (index % COLUMNS) as i32 * (block + GAP);
            draw_block(&area, (left, tops[index / COLUMNS]), stage)?;
        }
        scale(&area, (MARGIN, bottom))?;
        area.present()?;
    }
    Ok(figure.replace(" opacity=\"1\"", ""))
}

/// Draws one curve: name, numbers of the control points, and a cell per pair.
fn draw_block(area: &Area<'_>, (x, y): (i32, i32), stage: &StageReport) -> Drawn<()> {
    writing::write(area, &stage.name(), (x, y + NAME / 2), (TEXT, HPos::Left, INK))?;
    let (left, top) = (x + NUMBERS, y + NAME + NUMBERS);
    for (i, row) in stage.curve.correlations.iter().enumerate() {
        let middle = |i: usize| CELL * i as i32 + CELL / 2;
        let number = (i + 1).to_string();
        writing::write(area, &number, (left + middle(i), top - NUMBERS / 2), (TEXT, HPos::Center, INK))?;
        writing::write(area, &number, (x + NUMBERS / 2, top + middle(i)), (TEXT, HPos::Center, INK))?;
        for (j, value) in row.iter().enumerate() {
            let [from, to] = [0, 1].map(|by| (left + CELL * (j as i32 + by), top + CELL * (i as i32 + by)));
            let fill = value.map_or(UNKNOWN, colour);
            area.draw(&Rectangle::new([from, to], fill.filled()))?;
            area.draw(&Rectangle::new([from, to], WHITE.stroke_width(2)))?;
            let text = value.map_or("–".into(), |value| signed(format!("{value:.2}")));
            // White text on dark cells.
            let ink = if value.is_some_and(|value| value.abs() > 0.6) { WHITE } else { INK };
            writing::write(area, &text, (left + middle(j), top + middle(i)), (22, HPos::Center, ink))?;
        }
    }
    Ok(())
}

/// Draws the colour scale.
fn scale(area: &Area<'_>, (x, y): (i32, i32)) -> Drawn<()> {
    let wide = 20;
    for step in 0..=STEPS {
        let value = 2.0 * f64::from(step) / f64::from(STEPS) - 1.0;
        let from = x + wide * step;
        area.draw(&Rectangle::new([(from, y), (from + wide, y + SCALE)], colour(value).filled()))?;
    }
    let long = wide * (STEPS + 1);
    area.draw(&Rectangle::new([(x, y), (x + long, y + SCALE)], GREY.stroke_width(1)))?;
    for (text, at, place) in
        [("−1", x, HPos::Left), ("0", x + long / 2, HPos::Center), ("1", x + long, HPos::Right)]
    {
        writing::write(area, text, (at, y + SCALE + 24), (TEXT, place, INK))?;
    }
    writing::write(area, NAME_OF_SCALE, (x, y + SCALE + 68), (TEXT, HPos::Left, INK))?;
    let from = x + long + GAP;
    area.draw(&Rectangle::new([(from, y), (from + 2 * SCALE, y + SCALE)], UNKNOWN.filled()))?;
    writing::write(
        area,
        "not seen by the data",
        (from + 2 * SCALE + 12, y + SCALE / 2),
        (TEXT, HPos::Left, INK),
    )
}

/// Colour from blue through white to vermillion.
fn colour(value: f64) -> RGBColor {
    let full = if value < 0.0 { BLUE } else { VERMILLION };
    let share = value.abs().min(1.0);
    let mix = |part: u8| (255.0 + share * (f64::from(part) - 255.0)).round() as u8;
    RGBColor(mix(full.0), mix(full.1), mix(full.2))
}
