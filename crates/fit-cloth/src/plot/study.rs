//! Figures of a study.

mod bars;
mod convergence;
mod error_time;
mod noise;
mod parts;
mod stages;

use super::chart::Drawn;
use super::{BLUE, GREEN, GREY, PINK, VERMILLION};
use cloth_sim::material::Model;
use cloth_study::solver::Solver;
use cloth_study::study::Study;
use plotters::style::{Color, RGBColor, ShapeStyle};
use std::ops::Range;

/// Every figure with its name.
pub(super) fn figures(study: &Study) -> Vec<(String, Drawn<String>)> {
    let mut figures = vec![
        ("error-time".to_string(), error_time::of_fits(study)),
        ("noise".into(), noise::draw(study)),
        ("stages".into(), stages::draw(study)),
        ("parts".into(), parts::draw(study)),
    ];
    for scene in convergence::scenes(study) {
        let name = format!("error-time-{}", scene.replace(' ', "-"));
        figures.push((name, error_time::of_scene(study, &scene)));
    }
    for model in Model::ALL {
        let name = if model == Model::Stvk { "convergence".into() } else { format!("convergence-{model}") };
        figures.push((name, convergence::draw(study, model)));
    }
    figures
}

/// The colour of a model.
fn colour(model: Model) -> RGBColor {
    match model {
        Model::Stvk => BLUE,
        Model::SoftConstraint => VERMILLION,
        Model::Springs => GREEN,
    }
}

/// Dots of the default solver are filled, those of the published one open.
fn dot(model: Model, solver: Solver) -> (i32, ShapeStyle) {
    match solver {
        Solver::Default => (8, colour(model).filled()),
        Solver::AsPublished => (8, colour(model).stroke_width(3)),
    }
}

/// Decades that hold all values; `None` without any above zero.
fn decades(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for value in values.filter(|value| *value > 0.0) {
        (low, high) = (low.min(value), high.max(value));
    }
    (high > 0.0).then(|| 10f64.powf((0.9 * low).log10().floor())..10f64.powf((1.1 * high).log10().ceil()))
}
