//! A study: tables for the terminal and the page `study.md`.

mod digits;
mod equilibria;
mod fits;
mod noise;
mod parts;
mod section;
mod sections;

pub use section::Section;
pub use sections::sections;

use super::list::list;
use super::number::percent;
use cloth_sim::material::Model;
use cloth_study::run::{Ending, Part, Run};
use cloth_study::solver::Solver;
use cloth_study::study::Study;
use std::fmt::Write;

/// All tables, then the verdict.
pub fn study(study: &Study) -> String {
    let mut text = String::new();
    for section in sections(study) {
        let _ = writeln!(text, "{}\n\n{}", section.title, section.table());
    }
    text + &verdict(study)
}

/// The page: the verdict, and the tables with explanations and figures.
pub fn study_page(study: &Study) -> String {
    let mut text = format!("# Error and run time: {}\n\n{}", study.fabric, verdict(study));
    for section in sections(study) {
        let _ = write!(text, "\n## {}\n\n{}\n\n{}", section.title, section.words, section.table());
        if let Some(plot) = section.plot {
            let _ = write!(text, "\n![{}](plots/{plot}.svg)\n", section.title);
        }
    }
    text
}

/// The conclusions from the tables, as sentences.
fn verdict(study: &Study) -> String {
    let sentences = [fits(study), published(study), orders(study), failures(study)];
    sentences.into_iter().flatten().map(|sentence| sentence + "\n").collect()
}

fn named(run: &Run) -> String {
    let points = run.points.map(|points| format!(", {points} points")).unwrap_or_default();
    format!("{}, {}, {}x{} nodes{points}", run.model, run.solver, run.nodes, run.nodes)
}

fn fits(study: &Study) -> Option<String> {
    let error = |run: &Run| run.error_curve.unwrap_or(f64::INFINITY);
    let done = || study.part(Part::Fit).filter(|run| !run.failed() && run.error_curve.is_some());
    let best = done().min_by(|a, b| error(a).total_cmp(&error(b)))?;
    let near = done().filter(|run| error(run) <= 1.25 * error(best));
    let cheapest = near.min_by(|a, b| a.spent.seconds.total_cmp(&b.spent.seconds))?;
    let told =
        |run: &Run| format!("{} in {:.2} s ({})", percent(run.error_curve), run.spent.seconds, named(run));
    Some(match std::ptr::eq(best, cheapest) {
        true => format!(
            "The least curve error of a fit is {}, and none within a quarter of it is faster.",
            told(best)
        ),
        false => format!(
            "The least curve error of a fit is {}; the fastest within a quarter of it is {}.",
            told(best),
            told(cheapest)
        ),
    })
}

/// The default method against the published one, on the finest grid that both ran on.
fn published(study: &Study) -> Option<String> {
    let nodes = study.finest_fit()?;
    let of = |solver| {
        // The first run is the one with all points and frames.
        let mut runs = study.part(Part::Fit);
        runs.find(|run| run.solver == solver && run.model == Model::STVK && run.nodes == nodes)
    };
    let (default, published) = (of(Solver::Default)?, of(Solver::AsPublished)?);
    let [fast, slow] = [default, published].map(|run| run.spent);
    Some(format!(
        "The published method, with all points and frames on {0}x{0} nodes, takes {1:.1} times as long and {2:.1} times as many factorisations; it ended: {3}.",
        default.nodes,
        slow.seconds / fast.seconds,
        slow.counters.factorisations as f64 / fast.counters.factorisations.max(1) as f64,
        published.ending
    ))
}

fn orders(study: &Study) -> Option<String> {
    let of_stvk =
        || study.part(Part::Equilibrium).filter(|run| run.model == Model::STVK && run.order.is_some());
    let finest = of_stvk().map(|run| run.nodes).max()?;
    let orders = of_stvk()
        .filter(|run| run.nodes == finest && run.solver == Solver::Default)
        .filter_map(|run| Some(format!("{} {:.1}", run.test, run.order?)));
    Some(format!("Orders of convergence in the mesh size, stvk: {}.", list(orders)))
}

fn failures(study: &Study) -> Option<String> {
    let failed = study.runs.iter().filter(|run| run.failed()).count();
    let several = study.runs.iter().filter(|run| run.ending == Ending::SeveralEquilibria).count();
    Some(format!("{failed} of {} runs failed; {several} may have several equilibria.", study.runs.len()))
}
