//! Fits of the measurement set: all combinations of nodes, models and solvers; control points and frames one at a time.

use crate::extent::Extent;
use crate::mean::root_mean_square;
use crate::physical::Reference;
use crate::progress::Progress;
use crate::run::{Ending, Part, Run};
use crate::solver::Solver;
use crate::spent::{Spent, spend};
use crate::subject::Subject;
use cloth_data::error::Result;
use cloth_data::frame::MeasurementSet;
use cloth_fit::incremental::{self, FitReport, Stage};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::report::{SequenceReport, StageReport};
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::{Component, Model};

/// Maximum number of control points in a usual fit.
const POINTS: usize = 5;

/// Parameters of one fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Trial {
    pub(crate) model: Model,
    pub(crate) solver: Solver,
    pub(crate) nodes: usize,
    pub(crate) points: usize,
    /// Uses every n-th frame.
    pub(crate) every: usize,
}

impl Trial {
    /// StVK with the default settings.
    pub(crate) fn usual(nodes: usize) -> Self {
        Self { model: Model::STVK, solver: Solver::Default, nodes, points: POINTS, every: 1 }
    }

    pub(crate) fn settings(&self) -> Settings {
        let settings = Settings {
            model: self.model,
            nodes: Some([self.nodes; 2]),
            points: self.points,
            ..Settings::default()
        };
        self.solver.settings(settings)
    }
}

/// A fit and its rows: the whole fit first, then its stages.
pub(crate) struct Fitted {
    pub(crate) trial: Trial,
    pub(crate) rows: Vec<Run>,
    pub(crate) report: Option<FitReport>,
}

/// Reference for curve errors, and its description: the known curves, or the default fit on the finest grid.
///
/// # Errors
/// A set that cannot be fitted; invalid curves of a fabric.
pub(crate) fn reference(
    subject: &Subject,
    extent: &Extent,
    progress: &dyn Progress,
) -> Result<(Reference, String)> {
    let fabric = &subject.fabric;
    if subject.is_known {
        let reference = Reference { model: fabric.model, curves: fabric.curves()? };
        return Ok((reference, format!("the known curves of {}", fabric.name)));
    }
    let nodes = extent.fit_nodes.iter().copied().max().unwrap_or(extent.usual_nodes);
    progress.note(&format!("reference fit: {nodes}x{nodes}"));
    let settings = Trial::usual(nodes).settings();
    let known = Knowledge::default();
    let report = incremental::fit(&subject.set, &Stage::ALL, &known, &settings, &mut Watch::default())?;
    let reference = Reference { model: Model::STVK, curves: report.curves().clone() };
    Ok((reference, format!("the curves of the default fit on {nodes}x{nodes} nodes")))
}

/// All fit runs of a study.
pub(crate) fn runs(
    subject: &Subject,
    reference: &Reference,
    extent: &Extent,
    progress: &dyn Progress,
) -> Vec<Fitted> {
    let mut trials = Vec::new();
    for &model in &extent.models {
        for solver in Solver::ALL {
            let of_nodes = |&nodes| Trial { model, solver, ..Trial::usual(nodes) };
            let nodes = match solver {
                Solver::Default => &extent.fit_nodes,
                Solver::AsPublished => &extent.published_nodes,
            };
            trials.extend(nodes.iter().map(of_nodes));
        }
    }
    let usual = Trial::usual(extent.usual_nodes);
    trials.extend(extent.points.iter().map(|&points| Trial { points, ..usual }));
    trials.extend(extent.every_frames.iter().map(|&every| Trial { every, ..usual }));
    trials.iter().map(|trial| fit(&subject.set, reference, *trial, &trial.settings(), progress)).collect()
}

/// Runs one fit.
///
/// * `settings` — settings of the trial, possibly modified
pub(crate) fn fit(
    set: &MeasurementSet,
    reference: &Reference,
    trial: Trial,
    settings: &Settings,
    progress: &dyn Progress,
) -> Fitted {
    let Trial { model, solver, nodes, points, every } = trial;
    progress.note(&format!("fit, {model}, {solver}: {nodes}x{nodes}, {points} points, 1 of {every} frames"));
    let set = thinned(set, every);
    let meter = progress.meter();
    let mut watch = Watch { meter: meter.clone(), observe: Box::new(|_| ()) };
    let (found, spent) =
        spend(&meter, || incremental::fit(&set, &Stage::ALL, &Knowledge::default(), settings, &mut watch));
    let mut whole = Run::new(Part::Fit, "all", model, solver, nodes);
    whole.points = Some(points);
    whole.spent = spent;
    whole.frames = set.sequences.iter().map(|sequence| sequence.frames.len()).sum();
    let report = match found {
        Ok(report) => report,
        Err(error) => {
            whole.ending = Ending::Failed(error.to_string());
            return Fitted { trial, rows: vec![whole], report: None };
        }
    };
    let mut rows: Vec<Run> = report.stages.iter().map(|stage| row_of(stage, &whole, reference)).collect();
    whole.frames = report.sequences().iter().map(|(_, sequence)| sequence.frames).sum();
    whole.ending = ending(&report, reference);
    let sequences: Vec<&SequenceReport> = report.sequences().iter().map(|(_, sequence)| *sequence).collect();
    (whole.error_force, whole.error_position_mm) = residuals(&sequences);
    let errors = report.last_stages().filter(|stage| stage.curve.observed);
    whole.error_curve = root_mean_square(errors.filter_map(|stage| reference.distance(stage)));
    rows.insert(0, whole);
    Fitted { trial, rows, report: Some(report) }
}

/// Row of one stage of a fit.
fn row_of(stage: &StageReport, whole: &Run, reference: &Reference) -> Run {
    let pass = if stage.pass > 1 { " again" } else { "" };
    let sequences: Vec<&SequenceReport> = stage.sequences.iter().collect();
    let (error_force, error_position_mm) = residuals(&sequences);
    Run {
        part: Part::Stage,
        test: format!("{}{pass}", stage.name()),
        points: Some(stage.curve.curve.len()),
        frames: stage.sequences.iter().map(|sequence| sequence.frames).sum(),
        error_force,
        error_position_mm,
        error_curve: reference.distance(stage).filter(|_| stage.curve.observed),
        spent: Spent { seconds: stage.seconds, counters: stage.counters, peak_memory_mib: None },
        ending: match (stage.converged, stage.curve.observed) {
            (_, false) => Ending::Failed("not observed".into()),
            (false, _) => Ending::Failed("not converged".into()),
            _ => Ending::Converged,
        },
        ..whole.clone()
    }
}

/// Failed if a stage did not converge, or if a curve of the reference is missing.
fn ending(report: &FitReport, reference: &Reference) -> Ending {
    let lacking = |component: &Component| {
        reference.curves.get(*component).is_some()
            && report.stage(*component).is_none_or(|stage| !stage.curve.observed)
    };
    let missing: Vec<String> =
        Component::ALL.into_iter().filter(lacking).map(|component| component.to_string()).collect();
    if let Some(failure) = report.failures.first() {
        return Ending::Failed(failure.in_words());
    }
    if !missing.is_empty() {
        return Ending::Failed(format!("no curve of {}", missing.join(", ")));
    }
    match report.last_stages().find(|stage| !stage.converged) {
        Some(stage) => Ending::Failed(format!("{} has not converged", stage.name())),
        None => Ending::Converged,
    }
}

/// Force residual over the largest force, and position residual in mm; each is a root mean square over the sequences to
/// which it applies.
fn residuals(sequences: &[&SequenceReport]) -> (Option<f64>, Option<f64>) {
    let pulled = sequences.iter().filter(|sequence| sequence.force_largest > 0.0);
    let forces = pulled.filter_map(|sequence| Some(sequence.force_rms? / sequence.force_largest));
    let shown = sequences.iter().filter(|sequence| sequence.force_rms.is_none());
    let positions = shown.filter_map(|sequence| Some(1e3 * sequence.position_rms?));
    (root_mean_square(forces), root_mean_square(positions))
}

/// A set with every n-th frame, including the last frame of every load-only sequence.
fn thinned(set: &MeasurementSet, every: usize) -> MeasurementSet {
    let mut set = set.clone();
    for sequence in &mut set.sequences {
        // Counts from the middle of a loading–unloading cycle, where the load is largest, or from the end.
        let anchor =
            if sequence.table.is_some() { sequence.frames.len() - 1 } else { sequence.frames.len() / 2 };
        let frames = std::mem::take(&mut sequence.frames).into_iter().enumerate();
        let kept = frames.filter(|(index, _)| index.abs_diff(anchor).is_multiple_of(every));
        sequence.frames = kept.map(|(_, frame)| frame).collect();
    }
    set
}
