//! What the page shows of one fit.

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

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    model: String,
    variant: String,
    /// The verdict is green.
    sound: bool,
    /// How far to trust it, and why not farther.
    #[serde(default)]
    trust: String,
    /// In words: what was fitted to what, how it went, how good, how sure, what to measure next.
    about: String,
    state: String,
    good: String,
    sure: String,
    next: String,
    /// What failed.
    failures: Vec<String>,
    /// Contradictions within the measurements.
    #[serde(default)]
    notices: Vec<String>,
    /// All curves at a glance, in cells.
    summary: Vec<[String; 6]>,
    residuals: Vec<Residual>,
    curves: Vec<Curve>,
    sequences: Vec<Sequence>,
    courses: Vec<Course>,
}

/// How a sequence was met: the numbers of `residuals.csv` and `material.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Residual {
    sequence: String,
    /// No fit saw a sequence that was predicted.
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
    /// Collects what a fit found, and what it predicted of sequences that it did not see.
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
                // Grams have no more digits than the kilograms that were given.
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
            notices: report.notices.iter().map(|notice| notice.to_string()).collect(),
            summary: text::summary_rows(report),
            residuals: residuals.chain(more).collect(),
            curves: curves(report),
            sequences: sequences(set, &all, frames),
            courses: courses(report),
        }
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
