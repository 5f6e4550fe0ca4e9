//! The colours of figures.

use plotters::style::RGBColor;

// Okabe and Ito 2008: told apart by those who see red and green alike, too.
pub(super) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(super) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(super) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(super) const PINK: RGBColor = RGBColor(204, 121, 167);
pub(super) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(super) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(super) const GREY: RGBColor = RGBColor(110, 110, 110);

/// What was simulated, and what was measured, in every figure.
pub(super) const MODEL: RGBColor = BLUE;
pub(super) const MEASURED: RGBColor = VERMILLION;
