//! What each part that a scene can leave out saves, and which error it causes to leave it out.
//!
//! A scene is balanced with the part and without it, all frames of a test at the fabric's own curves. What concerns the fit
//! rather than a scene is read off the fits of the study.

use super::extent::Extent;
use super::fits::{Fitted, Trial, fit};
use super::physical::{Reference, between};
use super::run::{Ending, Spent, root_mean_square};
use super::scene::{Balanced, IN_SPACE, Scene, WEIGHT};
use super::solver::Solver;
use super::subject::Subject;
use crate::progress::Progress;
use cloth_fit::error::Result;
use cloth_fit::frame::Kind;
use cloth_fit::refine::GrowthRule;
use cloth_fit::replica::TableHold;
use cloth_fit::report::StageReport;
use cloth_fit::rig::{KnownFabric, Rig};
use cloth_fit::simulation::SolveStart;
use cloth_fit::stage::{Constraints, FirstStiffness, Plan, Settings, bend, shear, stretch};
use cloth_sim::equilibrium::{self, Method};
use cloth_sim::material::Component;
use nalgebra::Vector3;

/// Scenes are balanced so often, and the fastest counts.
const REPEATS: usize = 3;

/// One row of `ablation.csv`: a part, with and without it.
#[derive(Debug, Clone, PartialEq)]
pub struct Ablated {
    /// What is left out.
    pub part: String,
    /// Where.
    pub scene: String,
    /// A fit has it by default.
    pub by_default: bool,
    /// Cost with it.
    pub with: Spent,
    /// Cost without it.
    pub without: Spent,
    /// What leaving it out changes: largest change of a force, over the largest force.
    pub error_force: Option<f64>,
    /// Root mean square change of the nodes' places, mm.
    pub error_position_mm: Option<f64>,
    /// Root mean square change of a curve over its range, over the largest stress there.
    pub error_curve: Option<f64>,
    /// How the runs ended, with and without.
    pub ending: [Ending; 2],
}

impl Ablated {
    /// Share of the time that leaving it out saves; below zero if that costs time.
    pub fn saving(&self) -> f64 {
        1.0 - self.without.seconds / self.with.seconds.max(f64::MIN_POSITIVE)
    }

    /// The largest relative error that it causes to leave it out: of forces or of a curve.
    pub fn relative_error(&self) -> Option<f64> {
        self.error_force.into_iter().chain(self.error_curve).reduce(f64::max)
    }
}

/// A scene with a part, and the same without it.
struct Pair {
    part: &'static str,
    by_default: bool,
    with: (Scene, equilibrium::Settings),
    without: (Scene, equilibrium::Settings),
}

/// The parts of scenes.
///
/// # Errors
/// A scene that the rig cannot make.
pub(super) fn scenes(fabric: &KnownFabric, extent: &Extent, progress: &Progress) -> Result<Vec<Ablated>> {
    let reference = Reference { model: fabric.model, curves: fabric.curves()? };
    let nodes = extent.usual_nodes;
    let rig = || Rig { nodes: [extent.rig_nodes; 2], measured: [25, 25], frames: 6, ..Rig::default() };
    let strip = Scene::new(fabric, Kind::StretchWeft, rig(), stretch::plan(&[Component::StretchWeft]))?;
    let frame = Scene::new(fabric, Kind::Shear, rig(), shear::plan(2))?;
    let sheet = Scene::new(fabric, Kind::BendWarp, rig(), bend::plan(&[Component::BendWarp], 1))?;
    let pairs = of_strip(&strip).into_iter().chain(of_frame(&frame)).chain(of_sheet(&sheet));
    pairs
        .map(|pair| {
            progress.note(&format!("{}, {}", pair.part, pair.with.0.name));
            pair.balance(&reference, nodes)
        })
        .collect()
}

fn pair(part: &'static str, by_default: bool, with: Scene, without: Scene) -> Pair {
    let settings = equilibrium::Settings::default();
    Pair { part, by_default, with: (with, settings), without: (without, settings) }
}

/// A scene with more or other components.
fn of(scene: &Scene, components: &[Component]) -> Scene {
    let plan = Plan { components: components.to_vec(), ..scene.plan.clone() };
    Scene { plan, ..scene.clone() }
}

/// The strip of the stretch stage: none of these takes part in it by default.
fn of_strip(strip: &Scene) -> Vec<Pair> {
    let bends = [Component::BendWeft, Component::BendWarp, Component::BendDiagonal];
    let stretches = [Component::StretchWeft, Component::StretchWarp];
    let all_but_shear = [&stretches[..], &bends].concat();
    let in_space = || strip.clone().with_gravity(IN_SPACE);
    let heavy = of(strip, &all_but_shear).with_gravity(WEIGHT).without_shapes();
    vec![
        pair("out-of-plane unknowns", false, in_space(), strip.clone()),
        pair("bending", false, of(strip, &all_but_shear).with_gravity(IN_SPACE), in_space()),
        pair("shear", false, of(strip, &[stretches[0], stretches[1], Component::Shear]), strip.clone()),
        pair("weight, and what it needs", false, heavy, strip.clone()),
    ]
}

/// The picture frame of the second pass over shear.
fn of_frame(frame: &Scene) -> Vec<Pair> {
    let flat = Scene { plan: Plan { kinds: frame.plan.kinds.clone(), ..shear::plan(1) }, ..frame.clone() };
    let settings = equilibrium::Settings::default();
    let trusting = equilibrium::Settings { escape: false, ..settings };
    vec![
        pair("bending, and leaving the plane", true, frame.clone(), flat),
        solved("leaving unstable states, from flat", &frame.clone().without_shapes(), trusting),
        solved("mixed Newton", frame, damped()),
    ]
}

/// The sheet off a table of the stages of bending.
fn of_sheet(sheet: &Scene) -> Vec<Pair> {
    let without_shear: Vec<Component> =
        sheet.plan.components.iter().copied().filter(|component| *component != Component::Shear).collect();
    vec![
        pair("shear", true, sheet.clone(), of(sheet, &without_shear)),
        pair("weight", true, sheet.clone(), sheet.clone().with_gravity(Vector3::zeros())),
        solved("mixed Newton", sheet, damped()),
    ]
}

/// Levenberg–Marquardt instead, to the same tolerance.
fn damped() -> equilibrium::Settings {
    equilibrium::Settings { method: Method::LevenbergMarquardt, ..equilibrium::Settings::default() }
}

/// The same scene by other means.
fn solved(part: &'static str, scene: &Scene, without: equilibrium::Settings) -> Pair {
    let with = equilibrium::Settings::default();
    Pair { part, by_default: true, with: (scene.clone(), with), without: (scene.clone(), without) }
}

impl Pair {
    fn balance(&self, reference: &Reference, nodes: usize) -> Result<Ablated> {
        let [with, without] = [&self.with, &self.without].map(|(scene, equilibrium)| {
            let settings =
                Settings { nodes: Some([nodes; 2]), equilibrium: *equilibrium, ..Settings::default() };
            fastest(|| scene.balance(reference, &settings))
        });
        let (with, without) = (with?, without?);
        Ok(Ablated {
            part: self.part.into(),
            scene: self.with.0.name.clone(),
            by_default: self.by_default,
            error_force: without.force_error(&with),
            error_position_mm: without.position_error_mm(&with, nodes),
            error_curve: None,
            with: with.spent,
            without: without.spent,
            ending: [with.ending, without.ending],
        })
    }
}

fn fastest(mut run: impl FnMut() -> Result<Balanced>) -> Result<Balanced> {
    let mut best = run()?;
    for _ in 1..REPEATS {
        let again = run()?;
        if again.spent.seconds < best.spent.seconds {
            best = again;
        }
    }
    Ok(best)
}

/// Something that the published method does without.
type Published = (&'static str, fn(Settings) -> Settings);

/// What differs from the published method, one at a time.
const DIFFERENCES: [Published; 9] = [
    ("mixed Newton", |s| Settings { equilibrium: damped(), ..s }),
    ("start at the last equilibrium", |s| Settings { solve_start: SolveStart::Measured, ..s }),
    ("start from measurements", |s| Settings { first_stiffness: FirstStiffness::Constant, ..s }),
    ("stable curves", |s| Settings { constraints: Constraints::ControlPoints, ..s }),
    ("trust region, full convergence", |s| Settings { outer: s.clone().as_published().outer, ..s }),
    ("growth after a second try", |s| Settings { growth: GrowthRule::PUBLISHED, ..s }),
    ("lines held past the edge", |s| Settings { table: TableHold { past_edge: 0, ..s.table }, ..s }),
    ("lines that move as a whole", |s| Settings { table: TableHold { cylinder: false, ..s.table }, ..s }),
    ("errors of what is held", |s| Settings { table: TableHold { whitened: false, ..s.table }, ..s }),
];

/// The parts of fits: control points, the second pass, and what differs from the published method.
pub(super) fn of_fits(
    subject: &Subject,
    reference: &Reference,
    fits: &[Fitted],
    extent: &Extent,
    progress: &Progress,
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
    let published = of_trial(Trial { solver: Solver::AsPublished, ..usual });
    let published = published.and_then(|without| against("all that is not as published", with, without));
    fewer.chain(second_pass(with)).chain(differences).chain(published).collect()
}

/// One fit without what another has.
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

/// The second pass over shear and bending, from one fit: its stages are timed on their own.
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
