//! Types of the drawing backend.

use plotters::coord::Shift;
use plotters::prelude::*;
use std::error::Error;

/// Result of a drawing.
pub(super) type Drawn<T> = Result<T, Box<dyn Error>>;

/// The drawing area of a figure.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The chart that series are drawn in.
pub(super) type Context<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;
