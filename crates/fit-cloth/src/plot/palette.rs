//! Colours of the figures.

use plotters::style::RGBColor;

// Okabe and Ito 2008: distinguishable with colour-blindness.
pub(super) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(super) const VERMILLION: RGBColor = RGBColor(213, 94, 0);
pub(super) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(super) const PINK: RGBColor = RGBColor(204, 121, 167);
pub(super) const ORANGE: RGBColor = RGBColor(230, 159, 0);
pub(super) const SKY: RGBColor = RGBColor(86, 180, 233);
pub(super) const GREY: RGBColor = RGBColor(110, 110, 110);

/// Colours of simulated and measured data in every figure.
pub(super) const MODEL: RGBColor = BLUE;
pub(super) const MEASURED: RGBColor = VERMILLION;
