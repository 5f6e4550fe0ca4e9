//! Savings and errors of the parts of a fit.

use super::ablated::Ablated;
use crate::extent::Extent;
use crate::fits::{Fitted, Trial, fit};
use crate::mean::root_mean_square;
use crate::physical::{Reference, between};
use crate::progress::Progress;
use crate::solver::{Solver, damped};
use crate::subject::Subject;
use cloth_fit::equilibria::SolveStart;
use cloth_fit::stage::GrowthRule;
use cloth_fit::stage::report::StageReport;
use cloth_fit::stage::{Constraints, FirstStiffness, Settings};
use cloth_fit::twin::replica::TableHold;

/// A part that the published method lacks, and the settings without it.
type Published = (&'static str, fn(Settings) -> Settings);

/// Differences from the published method, applied one at a time.
const DIFFERENCES: [Published; 7] = [
    ("mixed Newton", |s| Settings { equilibrium: damped(), ..s }),
    ("start at the last equilibrium", |s| Settings { solve_start: SolveStart::Measured, ..s }),
    ("start from measurements", |s| Settings { first_stiffness: FirstStiffness::Constant, ..s }),
    ("stable curves", |s| Settings { constraints: Constraints::ControlPoints, ..s }),
    ("trust region, full convergence", |s| Settings { outer: s.clone().as_published().outer, ..s }),
    ("growth after a second try", |s| Settings { growth: GrowthRule::PUBLISHED, ..s }),
    ("edge that is found", |s| Settings { table: TableHold::AsSeen, ..s }),
];

/// Ablation of fits: control points, second pass, and differences from the published method.
pub(crate) fn of_fits(
    subject: &Subject,
    reference: &Reference,
    fits: &[Fitted],
    extent: &Extent,
    progress: &dyn Progress,
) -> Vec<Ablated> {
    let usual = Trial::usual(extent.usual_nodes);
    let of_trial = |trial: Trial| fits.iter().find(|fit| fit.trial == trial);
    let Some(with) = of_trial(usual) else { return Vec::new() };
    let fewer = extent.points.iter().filter_map(|&points| {
        let part = format!("more than {points} control point{}", if points == 1 { "" } else { "s" });
        against(&part, with, of_trial(Trial { points, ..usual })?)
    });
    let differences = DIFFERENCES.iter().filter_map(|(part, without)| {
        progress.note(&format!("fit without {part}"));
        let settings = without(usual.settings());
        against(part, with, &fit(&subject.set, reference, usual, &settings, progress))
    });
    // Fits with the published method take so long that they may not be run on the usual grid.
    let published = fits.iter().rev().find_map(|without| {
        let trial = Trial { solver: Solver::AsPublished, ..Trial::usual(without.trial.nodes) };
        let with = of_trial(Trial { solver: Solver::Default, ..trial })?;
        let part = format!("all that is not as published, {0}x{0}", trial.nodes);
        if without.trial == trial { against(&part, with, without) } else { None }
    });
    fewer.chain(second_pass(with)).chain(differences).chain(published).collect()
}

/// Compares two fits, one without a part.
fn against(part: &str, with: &Fitted, without: &Fitted) -> Option<Ablated> {
    let (full, lesser) = (with.report.as_ref()?, without.report.as_ref()?);
    let changes = full.last_stages().filter_map(|stage| between(lesser.stage(stage.components[0])?, stage));
    let [a, b] = [&with.rows[0], &without.rows[0]];
    Some(Ablated {
        part: part.into(),
        scene: "fit".into(),
        by_default: true,
        with: a.spent,
        without: b.spent,
        error_force: None,
        error_position_mm: None,
        error_curve: root_mean_square(changes),
        ending: [a.ending.clone(), b.ending.clone()],
    })
}

/// The second pass over shear and bending, from one fit whose stages are timed separately.
fn second_pass(fit: &Fitted) -> Option<Ablated> {
    let report = fit.report.as_ref()?;
    let second: Vec<&StageReport> = report.stages.iter().filter(|stage| stage.pass > 1).collect();
    let first = |stage: &StageReport| {
        report.stages.iter().find(|other| other.pass == 1 && other.components == stage.components)
    };
    let changes: Vec<f64> = second.iter().filter_map(|stage| between(first(stage)?, stage)).collect();
    let whole = &fit.rows[0];
    let mut without = whole.spent;
    for stage in &second {
        without.seconds -= stage.seconds;
        without.counters = without.counters.since(&stage.counters);
    }
    Some(Ablated {
        part: "second pass over shear and bending".into(),
        scene: "fit".into(),
        by_default: true,
        with: whole.spent,
        without,
        error_force: None,
        error_position_mm: None,
        error_curve: root_mean_square(changes.into_iter()),
        ending: [whole.ending.clone(), whole.ending.clone()],
    })
}
