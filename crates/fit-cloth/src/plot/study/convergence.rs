//! Position error against the number of cells per side, with a line of order two.

use super::extent::decades;
use crate::plot::chart::{Axes, log_figure};
use crate::plot::drawing::Drawn;
use crate::plot::palette::{BLUE, GREEN, GREY, PINK, VERMILLION};
use cloth_sim::material::Model;
use cloth_study::run::{Part, Run};
use cloth_study::solver::Solver;
use cloth_study::study::Study;
use plotters::style::Color;

const COLOURS: [plotters::style::RGBColor; 4] = [BLUE, VERMILLION, GREEN, PINK];

/// The scenes in the order of the runs.
pub(super) fn scenes(study: &Study) -> Vec<String> {
    let mut scenes: Vec<String> = Vec::new();
    for run in study.part(Part::Equilibrium) {
        if !scenes.contains(&run.test) {
            scenes.push(run.test.clone());
        }
    }
    scenes
}

/// Draws the scenes of one model.
///
/// # Errors
/// No equilibrium of the model.
pub(super) fn draw(study: &Study, model: Model) -> Drawn<String> {
    let usual = |run: &&Run| {
        run.model == model
            && run.solver == Solver::Default
            && run.tolerance == run.solver.equilibrium().tolerance
    };
    let runs: Vec<&Run> = study.part(Part::Equilibrium).filter(usual).collect();
    let point = |run: &Run| Some((cell(run), run.error_position_mm.filter(|error| *error > 0.0)?));
    let points: Vec<(f64, f64)> = runs.iter().filter_map(|run| point(run)).collect();
    let cells =
        points.iter().fold([f64::MAX, 0.0], |[low, high]: [f64; 2], (x, _)| [low.min(*x), high.max(*x)]);
    let errors = decades(points.iter().map(|(_, error)| *error)).ok_or("no errors")?;
    let title = format!("Equilibria on finer meshes, {model}");
    let axes = Axes {
        title: &title,
        x: ("cells per side", 0.8 * cells[0]..1.25 * cells[1]),
        y: ("position error [mm]", errors),
    };
    log_figure(axes, |chart| {
        for (scene, colour) in scenes(study).iter().zip(COLOURS) {
            let own = || runs.iter().filter(|run| run.test == *scene);
            let points: Vec<(f64, f64)> = own().filter_map(|run| point(run)).collect();
            if points.is_empty() {
                continue;
            }
            let order = own().filter_map(|run| run.order).next_back();
            let label = order.map_or(scene.clone(), |order| format!("{scene}: order {order:.1}"));
            chart.paths([points.clone()], colour.stroke_width(3), "");
            chart.dots(points.iter().copied(), (8, colour.filled()), &label);
        }
        let top = points.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        let guide = [cells[0], cells[1]].map(|x| (x, 0.5 * top * (cells[0] / x).powi(2)));
        chart.dashes(guide, GREY.stroke_width(3), "order 2");
    })
}

/// Cells per side.
fn cell(run: &Run) -> f64 {
    (run.nodes - 1) as f64
}
