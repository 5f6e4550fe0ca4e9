//! Tests curves on motions and samples outside the fit.
//!
//! Equilibria of a buckled sheet are discontinuous, and the distance between two shapes says little. Such tests
//! compare one aggregate measure per frame instead (Miguel et al. 2012, §6, figure 7).

use crate::judge::prediction::{Prediction, predict};
use crate::stage::report::{ForceRow, SequenceReport};
use crate::stage::{Settings, Watch};
use crate::twin::in_place;
use cloth_data::error::Result;
use cloth_data::frame::{Kind, MeasurementSet, Sequence};
use cloth_data::kind::Summary;
use cloth_data::measure::{Pull, aggregated_torque, clip_centres, pulls, stretching_force_difference};
use cloth_data::rectangle::rest_normal;
use cloth_sim::material::{Component, Curves};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A measure in one frame.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct MeasureRow {
    /// Index of the frame in its sequence.
    pub frame: usize,
    /// Extension of the test: see [`ReplicaFrame`](crate::twin::replica::ReplicaFrame::extension).
    pub extension: f64,
    /// Measured.
    pub measured: f64,
    /// Simulated.
    pub simulated: f64,
    /// True if the frame has several equilibria.
    pub multi_stable: bool,
}

/// Validation of one sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct Validated {
    /// Forces and shapes.
    pub report: SequenceReport,
    /// The aggregate measure and its rows, if the kind of test has one.
    pub measure: Option<(Summary, Vec<MeasureRow>)>,
}

impl Validated {
    /// Root mean square difference of the measure, in its unit.
    pub fn measure_rms(&self) -> Option<f64> {
        let (_, rows) = self.measure.as_ref()?;
        let square: f64 = rows.iter().map(|row| (row.measured - row.simulated).powi(2)).sum();
        Some((square / rows.len() as f64).sqrt())
    }

    /// RMS error as a share of the measured range.
    pub fn measure_share(&self) -> Option<f64> {
        let (_, rows) = self.measure.as_ref()?;
        let [low, high] = rows
            .iter()
            .fold([f64::MAX, f64::MIN], |[low, high], row| [low.min(row.measured), high.max(row.measured)]);
        Some(self.measure_rms()? / (high - low)).filter(|_| high > low)
    }
}

/// Validation of known curves on a set.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
pub struct Validation {
    /// Sequences of the requested kinds with at least one equilibrium.
    pub sequences: Vec<Validated>,
    /// The prediction: skipped frames, cost.
    pub prediction: Prediction,
}

impl Validation {
    /// Skipped frames of a sequence: at rest, or without an equilibrium.
    pub fn left_out(&self, sequence: &SequenceReport) -> usize {
        sequence.left_out(&self.prediction.dropped)
    }

    /// Sequences without any equilibrium, by name, with their number of frames.
    pub fn lost(&self) -> Vec<(&str, usize)> {
        let mut lost: Vec<&str> = self.prediction.dropped.iter().map(|frame| &frame.sequence[..]).collect();
        lost.dedup();
        lost.retain(|name| self.sequences.iter().all(|sequence| sequence.report.name != *name));
        lost.into_iter().map(|name| (name, self.without_equilibrium(name))).collect()
    }

    fn without_equilibrium(&self, name: &str) -> usize {
        self.prediction.dropped.iter().filter(|frame| frame.sequence == name).count()
    }
}

/// Predicts sequences of a set and computes their aggregate measures.
///
/// * `kinds` — tests to predict; others are skipped
/// * `assumed` — as in [`predict`]
///
/// # Errors
/// As [`predict`].
pub fn validate(
    set: &MeasurementSet,
    kinds: &[Kind],
    curves: &Curves,
    assumed: &BTreeMap<Component, f64>,
    settings: &Settings,
    watch: &Watch<'_>,
) -> Result<Validation> {
    let prediction = predict(set, kinds, curves, assumed, settings, watch)?;
    let validated = |report: &SequenceReport| {
        let sequence = set.sequences.iter().find(|sequence| sequence.name == report.name);
        let measure = report.kind.summary().zip(sequence);
        let rows = measure.map(|(measure, sequence)| (measure, measure_rows(measure, sequence, report)));
        Validated { report: report.clone(), measure: rows.filter(|(_, rows)| !rows.is_empty()) }
    };
    Ok(Validation { sequences: prediction.sequences.iter().map(validated).collect(), prediction })
}

/// The measure in every frame with all clip forces known.
fn measure_rows(measure: Summary, sequence: &Sequence, report: &SequenceReport) -> Vec<MeasureRow> {
    let mut frames: Vec<usize> = report.forces.iter().map(|row| row.frame).collect();
    frames.dedup();
    let row = |frame: usize| {
        let rows: Vec<&ForceRow> = report.forces.iter().filter(|row| row.frame == frame).collect();
        let of = |value: &dyn Fn(&ForceRow) -> f64| measured_whole(measure, sequence, frame, &rows, value);
        Some(MeasureRow {
            frame,
            extension: rows.first()?.extension,
            measured: of(&|row| row.measured)?,
            simulated: of(&|row| row.simulated)?,
            multi_stable: report.multi_stable.contains(&frame),
        })
    };
    frames.into_iter().filter_map(row).collect()
}

/// The measure of one frame from its force components, measured or simulated, in world axes.
fn measured_whole(
    measure: Summary,
    sequence: &Sequence,
    frame: usize,
    rows: &[&ForceRow],
    value: &dyn Fn(&ForceRow) -> f64,
) -> Option<f64> {
    let seen = &sequence.frames[frame];
    let centres = clip_centres(sequence, seen);
    let cords = pulls(sequence, seen);
    let points = centres.iter().enumerate().map(|(clip, centre)| {
        let own: Vec<Vector3<f64>> = cords.iter().filter(|p| p.clip == clip).map(|p| p.point).collect();
        if own.is_empty() { *centre } else { own.iter().sum::<Vector3<f64>>() / own.len() as f64 }
    });
    let forces: Vec<Pull> = points
        .enumerate()
        .map(|(clip, point)| {
            let components = rows.iter().filter(|row| row.clip == clip);
            Pull { clip, point, force: components.map(|row| row.world * value(row)).sum() }
        })
        .collect();
    if (0..centres.len()).any(|clip| !rows.iter().any(|row| row.clip == clip)) {
        return None;
    }
    let centre = centres.iter().sum::<Vector3<f64>>() / centres.len() as f64;
    match measure {
        Summary::AggregatedTorque => {
            let normal = rest_normal(&in_place(sequence).mesh);
            Some(aggregated_torque(&forces, &centres, &centre, &normal))
        }
        Summary::StretchingForceDifference => stretching_force_difference(&forces, &centres),
    }
}
