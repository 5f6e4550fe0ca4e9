//! Distances between simulated and measured tests, as comparable figures.

use crate::incremental::FitReport;
use crate::judge::prediction::Prediction;
use crate::stage::report::SequenceReport;
use cloth_data::frame::{MeasurementSet, Sequence};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Distance of some sequences from their measurements.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Distance {
    /// Root mean square over all measured force components, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_force_n: Option<f64>,
    /// Root mean square node distance over frames, m, of the sequences without forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_position_m: Option<f64>,
    /// The overall figure: see [`compare`](crate::judge::compare).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative: Option<f64>,
    /// Skipped frames: no equilibrium.
    pub dropped: usize,
}

impl Distance {
    /// Of the fitted sequences, with the final curves.
    pub(super) fn of_fit(set: &MeasurementSet, report: &FitReport) -> Self {
        let (mut sequences, mut dropped) = (Vec::new(), 0);
        for (stage, sequence) in report.sequences() {
            sequences.push(sequence);
            dropped += stage.left_out(sequence) - sequence.skipped.len();
        }
        Self::new(set, &sequences, dropped)
    }

    /// Of predicted sequences.
    pub(super) fn of_prediction(set: &MeasurementSet, prediction: &Prediction) -> Self {
        Self::new(set, &prediction.sequences.iter().collect::<Vec<_>>(), prediction.dropped.len())
    }

    fn new(set: &MeasurementSet, sequences: &[&SequenceReport], dropped: usize) -> Self {
        let forces = sequences.iter().filter_map(|s| Some((s.force_rms?, s.forces.len())));
        let shapes = sequences.iter().filter(|s| s.force_rms.is_none());
        Self {
            rms_force_n: pooled(forces),
            rms_position_m: pooled(shapes.filter_map(|s| Some((s.position_rms?, s.frames)))),
            relative: root_mean_square(sequences.iter().filter_map(|sequence| relative(set, sequence))),
            dropped,
        }
    }
}

/// The residual of a sequence as a share of its measured size.
fn relative(set: &MeasurementSet, report: &SequenceReport) -> Option<f64> {
    let (residual, scale) = match report.force_rms {
        Some(rms) => (rms, report.force_largest),
        None => {
            let sequence = set.sequences.iter().find(|sequence| sequence.name == report.name)?;
            (report.position_rms?, travel(sequence))
        }
    };
    (scale > 0.0).then(|| residual / scale)
}

/// The largest measured travel of a vertex, m: below the table's plane, or from its rest position.
fn travel(sequence: &Sequence) -> f64 {
    let normal = sequence.table.map(|table| {
        let [edge, outward] = [table.edge_direction, table.outward].map(Vector3::from);
        (Vector3::from(table.edge_point_m), edge.cross(&outward).normalize())
    });
    let way = |rest: &Vector3<f64>, now: &Vector3<f64>| match normal {
        Some((edge, normal)) => (now - edge).dot(&normal).abs(),
        None => (now - rest).norm(),
    };
    let shapes = sequence.frames.iter().filter_map(|frame| frame.positions.as_ref());
    let ways =
        shapes.flat_map(|shape| sequence.mesh.positions.iter().zip(shape).map(|(rest, now)| way(rest, now)));
    // An unobserved vertex is NaN, which `max` ignores.
    ways.fold(0.0, f64::max)
}

/// Root mean square of values.
pub(super) fn root_mean_square(values: impl Iterator<Item = f64>) -> Option<f64> {
    pooled(values.map(|value| (value, 1)))
}

/// Root mean square over groups with known root mean square and size.
fn pooled(groups: impl Iterator<Item = (f64, usize)>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0usize);
    for (rms, size) in groups {
        sum += rms * rms * size as f64;
        count += size;
    }
    (count > 0).then(|| (sum / count as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_count_by_their_size() {
        assert_eq!(pooled([(3.0, 1), (4.0, 1)].into_iter()), Some(12.5f64.sqrt()));
        assert_eq!(pooled([(3.0, 0), (4.0, 2)].into_iter()), Some(4.0));
        assert_eq!(root_mean_square(std::iter::empty()), None);
    }
}
