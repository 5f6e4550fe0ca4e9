//! Series of points and their legend.

use super::drawing::{Area, Context, Drawn};
use super::writing::{self, INK, TEXT};
use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

/// Height of a legend row, width of a mark, and the space after each part, in pixels.
pub(super) const ROW: i32 = 40;
const MARK: i32 = 40;
const GAP: i32 = 14;
/// End of a legend entry with non-finite points.
const LOST: &str = " points not drawn)";

/// Drawing style of points.
#[derive(Debug, Clone, Copy)]
pub(super) enum Mark {
    /// Filled polygons.
    Areas(RGBAColor),
    /// A line through the points of every piece; a single point is a dot.
    Line(ShapeStyle),
    /// A dashed line.
    Dashes(ShapeStyle),
    /// Dots of a given size.
    Dots(i32, ShapeStyle),
    /// Crosses.
    Crosses(ShapeStyle),
}

/// Points drawn in the same style, with an optional legend entry.
#[derive(Debug, Clone)]
pub(super) struct Series {
    mark: Mark,
    pieces: Vec<Vec<(f64, f64)>>,
    label: Option<String>,
}

impl Series {
    /// Drops non-finite points and counts them in the legend.
    pub(super) fn new(mark: Mark, pieces: impl IntoIterator<Item = Vec<(f64, f64)>>, label: &str) -> Self {
        let (mut all, mut lost) = (0, 0);
        let mut known = |mut piece: Vec<(f64, f64)>| {
            let given = piece.len();
            piece.retain(|(x, y)| x.is_finite() && y.is_finite());
            (all, lost) = (all + given, lost + given - piece.len());
            piece
        };
        let pieces: Vec<_> = pieces.into_iter().map(&mut known).filter(|piece| !piece.is_empty()).collect();
        let label = if lost > 0 { format!("{label} ({lost} of {all}{LOST}") } else { label.into() };
        Self { mark, pieces, label: Some(label).filter(|label| !label.is_empty()) }
    }

    /// True if the series has points to draw or to report as not drawn.
    pub(super) fn is_drawn(&self) -> bool {
        !self.pieces.is_empty() || self.label.as_ref().is_some_and(|label| label.ends_with(LOST))
    }

    pub(super) fn draw<X, Y>(&self, context: &mut Context<'_, '_, X, Y>) -> Drawn<()>
    where
        X: Ranged<ValueType = f64>,
        Y: Ranged<ValueType = f64>,
    {
        let points = || self.pieces.iter().flatten().copied();
        match self.mark {
            Mark::Areas(colour) => {
                context.draw_series(self.pieces.iter().map(|piece| Polygon::new(piece.clone(), colour)))?;
            }
            Mark::Line(style) => {
                let (alone, lines): (Vec<_>, Vec<_>) =
                    self.pieces.iter().cloned().partition(|piece| piece.len() == 1);
                context.draw_series(lines.into_iter().map(|piece| PathElement::new(piece, style)))?;
                let size = style.stroke_width as i32;
                let dot = |piece: Vec<(f64, f64)>| Circle::new(piece[0], size, style.filled());
                context.draw_series(alone.into_iter().map(dot))?;
            }
            Mark::Dashes(style) => {
                for piece in &self.pieces {
                    context.draw_series(DashedLineSeries::new(piece.iter().copied(), 12, 10, style))?;
                }
            }
            Mark::Dots(size, style) => {
                context.draw_series(points().map(|point| Circle::new(point, size, style)))?;
            }
            Mark::Crosses(style) => {
                context.draw_series(points().map(|point| Cross::new(point, 10, style)))?;
            }
        }
        Ok(())
    }

    /// Draws the mark of the legend entry, to the right of a point.
    fn sample(&self, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn<()> {
        let middle = (x + MARK / 2, y);
        match self.mark {
            Mark::Areas(colour) => {
                area.draw(&Rectangle::new([(x, y - 13), (x + MARK, y + 13)], colour.filled()))?
            }
            Mark::Line(style) => area.draw(&PathElement::new([(x, y), (x + MARK, y)], style))?,
            Mark::Dashes(style) => {
                for from in [x, x + MARK - 14] {
                    area.draw(&PathElement::new([(from, y), (from + 14, y)], style))?;
                }
            }
            Mark::Dots(size, style) => area.draw(&Circle::new(middle, size, style))?,
            Mark::Crosses(style) => area.draw(&Cross::new(middle, 10, style))?,
        }
        Ok(())
    }
}

/// Draws the named series in rows that fit the figure; returns the height of all rows, in pixels.
pub(super) fn legend(area: &Area<'_>, series: &[&Series], from: (i32, i32), to: i32) -> Drawn<i32> {
    let (mut x, mut y) = (from.0, from.1 + ROW / 2);
    let mut rows = 0;
    for (series, label) in series.iter().filter_map(|series| Some((series, series.label.as_ref()?))) {
        let wide = MARK + GAP + writing::width(label, TEXT);
        if rows == 0 {
            rows = 1;
        } else if x + wide > to {
            (x, y, rows) = (from.0, y + ROW, rows + 1);
        }
        series.sample(area, (x, y))?;
        writing::write(area, label, (x + MARK + GAP, y), (TEXT, HPos::Left, INK))?;
        x += wide + 2 * GAP;
    }
    Ok(rows * ROW)
}
