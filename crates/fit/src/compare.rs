//! Models and variants side by side on one measurement set: which one to use.
//!
//! ```text
//! relative residual of a sequence     rms force / largest measured force        where forces were measured
//!                                     rms position / largest measured travel    where only shapes were
//! overall figure of some sequences    root mean square of their relative residuals
//! ```
//!
//! The travel of a sheet on a table is its drop below the table's plane; that of another, the way from its rest shape.
//! More parameters always fit better. So what ranks is, if there is one, the figure of sequences that the fit did not
//! see: complex shear and corner pulls, else sequences left out one at a time, where all could spare the same ones.
//!
//! Source: Miguel et al. 2012, §6 (models, variants, validation motions).

mod distance;
mod leave_out;
mod ranking;
mod table;

pub use distance::Distance;
pub use leave_out::LeftOut;
pub use ranking::{Comparison, Criterion};

use crate::error::{Error, Result};
use crate::frame::{Kind, MeasurementSet};
use crate::incremental::{self, FitReport, Stage};
use crate::knowledge::Knowledge;
use crate::prediction::{Prediction, predict};
use crate::report::StageReport;
use crate::stage::{Settings, Variant, Watch};
use cloth_sim::material::{Component, Model};
use serde::{Deserialize, Serialize};

/// Tests that no stage fits.
pub const VALIDATION: [Kind; 2] = [Kind::ComplexShear, Kind::CornerPull];

/// One model in one variant.
#[must_use]
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The model.
    pub model: Model,
    /// The variant.
    pub variant: Variant,
    /// Why there is no fit, if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Control values of all observed curves; a shared one counts once.
    pub parameters: usize,
    /// Components that no sequence shows, or not well enough.
    pub missing: Vec<Component>,
    /// On the sequences that were fitted.
    pub fit: Distance,
    /// On those left for validation, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub validation: Option<Distance>,
    /// Every sequence left out in turn, if asked for.
    pub left_out: Vec<LeftOut>,
    /// Overall figure of the sequences left out; `None` if none could be spared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leave_one_out: Option<f64>,
    /// Equilibria sought in the fit.
    pub equilibria: usize,
    /// Factorisations in the fit.
    pub factorisations: usize,
    /// Wall time of the fit, s.
    pub seconds: f64,
    /// Every stage came to its minimum.
    pub converged: bool,
}

/// The settings of all models and variants, all else as given.
pub fn contestants(base: &Settings) -> Vec<Settings> {
    let of_model =
        |model| Variant::ALL.into_iter().map(move |variant| Settings { model, variant, ..base.clone() });
    Model::ALL.into_iter().flat_map(of_model).collect()
}

/// One model in one variant: its figures, and all that they sum up.
#[must_use]
#[derive(Debug, Clone)]
pub struct Entry {
    /// The figures.
    pub row: Row,
    /// What the fit found.
    pub report: FitReport,
    /// How it meets the sequences left for validation, if there are any.
    pub validation: Option<Prediction>,
}

/// Fits one model in one variant and predicts what it did not see.
///
/// # Errors
/// As [`incremental::fit`].
pub fn run(
    set: &MeasurementSet,
    settings: &Settings,
    leave_one_out: bool,
    watch: &mut Watch<'_>,
) -> Result<Entry> {
    let report = incremental::fit(set, &Stage::ALL, &Knowledge::default(), settings, watch)?;
    let left_out = match leave_one_out {
        true => leave_out::each(set, &report, settings, watch),
        false => Vec::new(),
    };
    let validation = validation(set, &report, settings, watch)?;
    let sum = |count: fn(&StageReport) -> usize| report.stages.iter().map(count).sum();
    let row = Row {
        model: settings.model,
        variant: settings.variant,
        failure: None,
        parameters: observed(&report).map(|stage| stage.curve.curve.len()).sum(),
        missing: missing(&report),
        fit: Distance::of_fit(set, &report),
        validation: validation.as_ref().map(|found| Distance::of_prediction(set, found)),
        leave_one_out: distance::root_mean_square(left_out.iter().filter_map(LeftOut::relative)),
        left_out,
        equilibria: sum(|stage| stage.counters.equilibria),
        factorisations: sum(|stage| stage.counters.factorisations),
        seconds: report.stages.iter().map(|stage| stage.seconds).sum(),
        converged: report.converged(),
    };
    Ok(Entry { row, report, validation })
}

impl Row {
    /// A row for what could not be fitted.
    pub fn failed(settings: &Settings, error: &Error) -> Self {
        Self {
            model: settings.model,
            variant: settings.variant,
            failure: Some(error.to_string()),
            parameters: 0,
            missing: Component::ALL.to_vec(),
            fit: Distance::default(),
            validation: None,
            left_out: Vec::new(),
            leave_one_out: None,
            equilibria: 0,
            factorisations: 0,
            seconds: 0.0,
            converged: false,
        }
    }

    /// Frames without an equilibrium, which an overall figure does not see.
    fn dropped(&self, criterion: Criterion) -> usize {
        match criterion {
            Criterion::Validation => self.validation.map_or(0, |distance| distance.dropped),
            Criterion::LeaveOneOut | Criterion::Fit => self.fit.dropped,
        }
    }

    /// An overall figure; `None` if there is nothing to tell it by.
    pub fn figure(&self, criterion: Criterion) -> Option<f64> {
        match criterion {
            Criterion::Validation => self.validation?.relative,
            Criterion::LeaveOneOut => self.leave_one_out,
            Criterion::Fit => self.fit.relative,
        }
    }
}

/// Without a stretch curve a sheet has no shape to predict.
fn validation(
    set: &MeasurementSet,
    report: &FitReport,
    settings: &Settings,
    watch: &Watch<'_>,
) -> Result<Option<Prediction>> {
    let any = set.sequences.iter().any(|sequence| VALIDATION.contains(&sequence.kind));
    if !any || !report.curves().components().any(Component::is_stretch) {
        return Ok(None);
    }
    Ok(Some(predict(set, &VALIDATION, report.curves(), &report.assumed(), settings, watch)?))
}

fn observed(report: &FitReport) -> impl Iterator<Item = &StageReport> {
    report.last_stages().filter(|stage| stage.curve.observed)
}

fn missing(report: &FitReport) -> Vec<Component> {
    Component::ALL.into_iter().filter(|&component| !report.knowledge.knows(component)).collect()
}
