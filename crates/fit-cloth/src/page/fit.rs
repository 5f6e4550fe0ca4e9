//! One fit on the page.

use super::curves::{Course, Curve, courses, curves};
use super::sequences::{Frames, Sequence, sequences};
use crate::text;
use cloth_data::frame::MeasurementSet;
use cloth_fit::equilibria::DroppedFrame;
use cloth_fit::incremental::FitReport;
use cloth_fit::judge::prediction::Prediction;
use cloth_fit::judge::verdict::Grade;
use cloth_fit::material::file::ResidualEntry;
use cloth_fit::stage::report::SequenceReport;
use serde::{Deserialize, Serialize};

/// Data of one fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    model: String,
    variant: String,
    /// True if the verdict is green.
    sound: bool,
    /// The verdict and its reasons.
    #[serde(default)]
    trust: String,
    /// Sentences: subject of the fit, state, residuals, uncertainty, next measurement.
    about: String,
    state: String,
    good: String,
    sure: String,
    next: String,
    /// Failed stages.
    failures: Vec<String>,
    /// Contradictions within the measurements.
    #[serde(default)]
    notices: Vec<String>,
    /// Summary of all curves, as cells.
    summary: Vec<[String; 6]>,
    residuals: Vec<Residual>,
    curves: Vec<Curve>,
    sequences: Vec<Sequence>,
    courses: Vec<Course>,
}

/// Residuals of a sequence, as in `residuals.csv` and `material.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Residual {
    sequence: String,
    /// True if the sequence was predicted, not fitted.
    predicted: bool,
    frames: usize,
    frames_left_out: usize,
    multi_stable_frames: usize,
    rms_force_n: Option<f64>,
    largest_force_n: Option<f64>,
    rms_position_m: Option<f64>,
    loading_stiffness: Option<f64>,
    unloading_stiffness: Option<f64>,
}

impl Fit {
    /// Collects the results of a fit and its predictions of sequences that it did not use.
    pub fn new(
        set: &MeasurementSet,
        report: &FitReport,
        prediction: Option<&Prediction>,
        frames: Frames,
    ) -> Self {
        let fitted = report.sequences();
        let predicted =
            || prediction.into_iter().flat_map(|found| found.sequences.iter().map(move |s| (found, s)));
        let overall = text::overall(report);
        let residuals = fitted.iter().map(|(stage, sequence)| Residual::new(sequence, &stage.dropped, false));
        let more = predicted().map(|(found, sequence)| Residual::new(sequence, &found.dropped, true));
        let all: Vec<&SequenceReport> = fitted
            .iter()
            .map(|(_, sequence)| *sequence)
            .chain(predicted().map(|(_, sequence)| sequence))
            .collect();
        Self {
            model: report.model.to_string(),
            variant: report.variant.to_string(),
            sound: overall.verdict.grade == Grade::Green,
            trust: text::verdict_of_fit(report),
            about: format!(
                "{} of {} g/m², fitted as {}, {}, to {} frames of {} tests.",
                set.fabric.name,
                // Without trailing zeros: no more digits than the given kilograms.
                format!("{:.3}", 1e3 * set.fabric.areal_density_kg_m2)
                    .trim_end_matches('0')
                    .trim_end_matches('.'),
                report.model,
                report.variant,
                fitted.iter().map(|(_, sequence)| sequence.frames).sum::<usize>(),
                fitted.len()
            ),
            state: overall.state,
            good: overall.good,
            sure: overall.sure,
            next: overall.next,
            failures: report.failures.iter().map(|failure| failure.in_words()).collect(),
            notices: report.notices.iter().map(text::notice).collect(),
            summary: text::summary_rows(report),
            residuals: residuals.chain(more).collect(),
            curves: curves(report),
            sequences: sequences(set, &all, frames),
            courses: courses(report),
        }
    }

    /// States that its curves are for one mesh, if they are.
    ///
    /// * `side` — of the mesh's cells, m
    pub fn for_mesh(mut self, side: Option<f64>) -> Self {
        if let Some(side) = side {
            self.about = format!("{} {}.", self.about, text::for_mesh(side));
        }
        self
    }
}

impl Residual {
    fn new(sequence: &SequenceReport, dropped: &[DroppedFrame], predicted: bool) -> Self {
        let entry = ResidualEntry::new(sequence, dropped);
        Self {
            predicted,
            frames_left_out: sequence.left_out(dropped),
            sequence: entry.sequence,
            frames: entry.frames,
            multi_stable_frames: entry.multi_stable_frames.len(),
            rms_force_n: entry.rms_force_n,
            largest_force_n: entry.largest_force_n,
            rms_position_m: entry.rms_position_m,
            loading_stiffness: entry.loading_stiffness,
            unloading_stiffness: entry.unloading_stiffness,
        }
    }
}
