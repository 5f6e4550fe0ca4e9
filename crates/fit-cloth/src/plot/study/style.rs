//! Styles of models and solvers.

use crate::plot::palette::{BLUE, GREEN, VERMILLION};
use cloth_sim::material::Model;
use cloth_study::solver::Solver;
use plotters::style::{Color, RGBColor, ShapeStyle};

/// The colour of a model.
pub(super) fn colour(model: Model) -> RGBColor {
    let colours = [BLUE, VERMILLION, GREEN];
    let place = Model::ALL.iter().position(|other| *other == model).unwrap_or_default();
    colours[place % colours.len()]
}

/// Dots of the default solver are filled, those of the published one open.
pub(super) fn dot(model: Model, solver: Solver) -> (i32, ShapeStyle) {
    match solver {
        Solver::Default => (8, colour(model).filled()),
        Solver::AsPublished => (8, colour(model).stroke_width(3)),
    }
}
