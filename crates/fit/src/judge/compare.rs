//! Ranks models and variants on one measurement set.
//!
//! ```text
//! relative residual of a sequence     rms force / largest measured force        where forces were measured
//!                                     rms position / largest measured travel    where only shapes were
//! overall figure of some sequences    root mean square of their relative residuals
//! ```
//!
//! The travel of a sheet on a table is its drop below the table's plane; that of any other sheet, the distance from
//! its rest shape. More parameters always fit better, so the ranking uses sequences outside the fit: complex shear
//! and corner pulls if there are any, else sequences left out one at a time, provided that all entries could spare
//! the same ones.
//!
//! Source: Miguel et al. 2012, §6 (models, variants, validation motions).

mod distance;
mod leave_out;
mod ranking;
mod row;
mod table;

pub use distance::Distance;
pub use leave_out::LeftOut;
pub use ranking::Comparison;
pub use row::{Criterion, Row};

use crate::incremental::{self, FitReport, Stage};
use crate::judge::prediction::{Prediction, predict};
use crate::stage::knowledge::Knowledge;
use crate::stage::report::StageReport;
use crate::stage::{Settings, Variant, Watch};
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet};
use cloth_sim::material::{Component, Model};

/// Tests that no stage fits.
pub fn validation_kinds() -> Vec<Kind> {
    Kind::ALL.into_iter().filter(|kind| kind.shows().is_empty()).collect()
}

/// The settings of every model and variant, otherwise as given.
pub fn contestants(base: &Settings) -> Vec<Settings> {
    let of_model =
        |model| Variant::ALL.into_iter().map(move |variant| Settings { model, variant, ..base.clone() });
    Model::ALL.into_iter().flat_map(of_model).collect()
}

/// One model in one variant: its figures, and the reports that they summarise.
#[must_use]
#[derive(Debug, Clone)]
pub struct Entry {
    /// The figures.
    pub row: Row,
    /// Report of the fit.
    pub report: FitReport,
    /// Prediction of the validation sequences, if there are any.
    pub validation: Option<Prediction>,
}

/// Fits one model in one variant and predicts the sequences outside the fit.
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
        missing: report.missing(),
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

/// Without a stretch curve there is no prediction: nothing resists the pull of the clips.
fn validation(
    set: &MeasurementSet,
    report: &FitReport,
    settings: &Settings,
    watch: &Watch<'_>,
) -> Result<Option<Prediction>> {
    let any = set.sequences.iter().any(|sequence| sequence.kind.shows().is_empty());
    if !any || !report.curves().components().any(Component::is_stretch) {
        return Ok(None);
    }
    Ok(Some(predict(set, &validation_kinds(), report.curves(), &report.assumed(), settings, watch)?))
}

fn observed(report: &FitReport) -> impl Iterator<Item = &StageReport> {
    report.last_stages().filter(|stage| stage.curve.observed)
}
