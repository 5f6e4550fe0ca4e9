//! Where figures are drawn, and what comes of it.

use plotters::coord::Shift;
use plotters::prelude::*;
use std::error::Error;

/// What a drawing may fail with.
pub(super) type Drawn<T> = Result<T, Box<dyn Error>>;

/// Where a figure is drawn.
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Where series are drawn.
pub(super) type Context<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;
