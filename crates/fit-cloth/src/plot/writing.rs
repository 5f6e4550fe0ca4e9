//! Text in figures.
//!
//! The viewer's fonts are unknown: a character is taken as 0.6 of the size wide, more than most are.

use super::drawing::{Area, Drawn};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Font sizes of titles and other text, in plotters' units, `MEASURE` times the size in pixels.
pub(super) const TITLE: i32 = 36;
pub(super) const TEXT: i32 = 28;
const MEASURE: f64 = 1.24;
/// Minimum readable size.
const SMALLEST: i32 = 20;

/// Colour of text other than legend entries.
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);

/// Upper bound of a text's width, in pixels.
pub(super) fn width(text: &str, size: i32) -> i32 {
    (0.6 * f64::from(size) / MEASURE * text.chars().count() as f64).ceil() as i32
}

/// Writes a line that begins, is centred or ends at a point; it is centred vertically.
pub(super) fn write(
    area: &Area<'_>,
    text: &str,
    at: (i32, i32),
    (size, place, colour): (i32, HPos, RGBColor),
) -> Drawn<()> {
    let style = ("sans-serif", size).into_font().color(&colour).pos(Pos::new(place, VPos::Center));
    Ok(area.draw(&Text::new(text, at, style))?)
}

/// Replaces hyphens in a number by minus signs, which are as wide as a digit.
pub(super) fn signed(number: String) -> String {
    number.replace('-', "−")
}

/// Writes a line no wider than the given pixels: reduced in size, then cut off.
pub(super) fn write_within(
    area: &Area<'_>,
    most: i32,
    text: &str,
    at: (i32, i32),
    (size, place, colour): (i32, HPos, RGBColor),
) -> Drawn<()> {
    let fits = |size: &i32| width(text, *size) <= most;
    match (SMALLEST..=size).rev().find(fits) {
        Some(size) => write(area, text, at, (size, place, colour)),
        None => {
            let characters = (0..text.chars().count()).rev();
            let cut = |kept: usize| text.chars().take(kept).chain(['…']).collect::<String>();
            let cut = characters.map(cut).find(|cut| width(cut, SMALLEST) <= most).unwrap_or_default();
            write(area, &cut, at, (SMALLEST, place, colour))
        }
    }
}
