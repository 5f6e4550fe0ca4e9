//! Error against wall time, a line per model and solver; failed runs are crosses, at the top if they have no error.

use super::extent::decades;
use super::style::{colour, dot};
use crate::plot::chart::{Axes, log_figure};
use crate::plot::drawing::Drawn;
use cloth_sim::material::Model;
use cloth_study::pareto::front;
use cloth_study::run::{Part, Run};
use cloth_study::solver::Solver;
use cloth_study::study::Study;
use plotters::style::{BLACK, Color};

/// Draws the fits with all control points and frames.
///
/// # Errors
/// No fit.
pub(super) fn of_fits(study: &Study) -> Drawn<String> {
    let fits = || study.part(Part::Fit);
    let points = fits().filter_map(|run| run.points).max();
    // A fit that lost a frame or failed is included; one that was given fewer frames is not.
    let frames = |nodes: usize| fits().filter(|run| run.nodes == nodes).map(|run| run.frames).max();
    let whole =
        |run: &&Run| run.points == points && frames(run.nodes).is_some_and(|all| 10 * run.frames > 8 * all);
    let runs: Vec<&Run> = fits().filter(whole).collect();
    draw("Fits: error against run time", "curve error, share of the largest stress", &runs, |run| {
        run.error_curve
    })
}

/// Draws one scene's equilibria with the default tolerance.
///
/// # Errors
/// No equilibrium.
pub(super) fn of_scene(study: &Study, scene: &str) -> Drawn<String> {
    let usual = |run: &&Run| run.test == scene && run.tolerance == run.solver.equilibrium().tolerance;
    let finest = study.part(Part::Equilibrium).map(|run| run.nodes).max();
    let runs: Vec<&Run> =
        study.part(Part::Equilibrium).filter(usual).filter(|run| Some(run.nodes) != finest).collect();
    let title = format!("Equilibrium, {scene}: error against run time");
    draw(&title, "position error [mm]", &runs, |run| run.error_position_mm)
}

fn draw(title: &str, y: &str, runs: &[&Run], error: impl Fn(&Run) -> Option<f64>) -> Drawn<String> {
    let point = |run: &Run| Some((run.spent.seconds, error(run).filter(|error| *error > 0.0)?));
    let times = decades(runs.iter().map(|run| run.spent.seconds)).ok_or("no runs")?;
    let errors =
        decades(runs.iter().filter_map(|run| point(run)).map(|(_, error)| error)).ok_or("no errors")?;
    // Room for failed runs.
    let (times, errors) = (times, errors.start..errors.end * 2.0);
    let top = errors.end / 1.4;
    let done: Vec<&&Run> = runs.iter().filter(|run| !run.failed() && point(run).is_some()).collect();
    let best: Vec<[f64; 2]> = done.iter().filter_map(|run| point(run)).map(<[f64; 2]>::from).collect();
    let failed = |model: Model| -> Vec<(f64, f64)> {
        let own = runs.iter().filter(|run| run.failed() && run.model == model);
        own.map(|run| point(run).unwrap_or((run.spent.seconds, top))).collect()
    };
    let axes = Axes { title, x: ("wall time [s]", times), y: (y, errors) };
    log_figure(axes, |chart| {
        let front = front(&best).into_iter().map(|[seconds, error]| (seconds, error));
        chart.dashes(front, BLACK.mix(0.55).stroke_width(9), "Pareto front");
        for model in Model::ALL {
            for solver in Solver::ALL {
                let own = done.iter().filter(|run| run.model == model && run.solver == solver);
                let points: Vec<(f64, f64)> = own.filter_map(|run| point(run)).collect();
                if points.is_empty() {
                    continue;
                }
                let (size, style) = dot(model, solver);
                chart.paths([points.clone()], colour(model).stroke_width(3), "");
                chart.dots(points.iter().copied(), (size, style), &format!("{model}, {solver}"));
            }
        }
        for model in Model::ALL.into_iter().filter(|&model| !failed(model).is_empty()) {
            let style = colour(model).stroke_width(4);
            chart.crosses(failed(model), style, &format!("{model}, failed"));
        }
    })
}
