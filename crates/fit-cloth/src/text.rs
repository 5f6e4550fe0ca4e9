//! What a person reads: tables, and a verdict in words.

mod check;
mod comparison;
mod overall;
mod residuals;
mod simulation;
mod stage;
mod study;
mod summary;
mod validation;
mod verdict;

pub use check::{check, repaired};
pub use comparison::{comparison, ranking};
pub use overall::{Overall, overall};
pub use residuals::residuals;
pub use simulation::simulation;
pub use stage::{course, stage};
pub use study::{Section, sections, study, study_page};
pub use summary::{as_published, missing, summary, summary_rows};
pub use validation::{other_grid, validation};
pub use verdict::{verdict, verdict_of_fit};

use cloth_fit::curve_file::Kind;
use cloth_fit::interventions::Interventions;
use cloth_fit::report::{Sample, StageReport};
use cloth_fit::simulation::Objective;
use cloth_sim::material::{Component, Model};
use std::fmt::Display;

/// Items with commas between them.
fn list(items: impl IntoIterator<Item = impl Display>) -> String {
    items.into_iter().map(|item| item.to_string()).collect::<Vec<_>>().join(", ")
}

/// In what a stage's residuals are shown: the unit, and how many of it make one of SI.
fn unit(stage: &StageReport) -> (&'static str, f64) {
    match stage.objective {
        Objective::Forces => ("N", 1.0),
        Objective::Positions => ("mm", 1e3),
    }
}

/// What a curve is over, and what it gives.
pub(crate) fn curve_labels(model: Model, component: Component) -> [String; 2] {
    let [strain, stress] = Kind::of(component, model).names();
    match component.is_bending() {
        true => [format!("{strain} [1/m]"), format!("{stress} [N]")],
        false => [format!("{strain} [–]"), format!("{stress} [N/m]")],
    }
}

/// What helped solves and fits along, on a line; nothing where nothing did.
fn interventions(interventions: &Interventions) -> String {
    match interventions.in_words()[..] {
        [] => String::new(),
        ref words => format!("  helped along by: {}\n", list(words)),
    }
}

/// Half a band this many times what it is about is no knowledge of it.
pub(crate) const NO_KNOWLEDGE: f64 = 10.0;

/// Half a sample's 95 % band over its stress; nothing where that is not known.
fn half_band(sample: &Sample) -> Option<f64> {
    let [low, high] = sample.band?;
    // Infinite, or no number, where there is no stress.
    Some(0.5 * (high - low) / sample.stress.abs()).filter(|half| *half < NO_KNOWLEDGE)
}

/// A number, or a dash where there is none.
fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or("-".into(), |value| format!("{value:.digits$}"))
}

/// A share in per cent, or a dash.
fn percent(share: Option<f64>) -> String {
    share.map_or("-".into(), |share| format!("{:.2} %", 100.0 * share))
}

/// Half a band as a share, in per cent; what rounds to nothing is not said to be nothing.
fn sure(share: f64) -> String {
    if share < 5e-4 { "0.1 % or better".into() } else { format!("{:.1} %", 100.0 * share) }
}

/// The strains or curvatures between which a stage's curve was seen.
fn seen(stage: &StageReport) -> String {
    let digits = if stage.components[0].is_bending() { 2 } else { 4 };
    let [low, high] = stage.curve.seen.map(|strain| {
        let text = format!("{strain:.digits$}");
        // What rounds to zero has no sign.
        if text.trim_start_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text }
    });
    format!("{low} to {high}")
}
