//! The force on a clip, measured and simulated.

use cloth_data::frame::Sequence;
use cloth_data::measure::clip_centres;
use cloth_fit::stage::report::{ForceRow, SequenceReport};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Force of the cords on a clip, N, and the clip's centre, m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClipForce {
    pub(crate) at: [f64; 3],
    pub(crate) measured: [f64; 3],
    pub(crate) simulated: [f64; 3],
}

/// Measured and simulated force on each clip of a frame, along the measured components; clips without a force are
/// omitted.
pub(crate) fn clip_forces(sequence: &Sequence, found: &SequenceReport, frame: usize) -> Vec<ClipForce> {
    let centres = clip_centres(sequence, &sequence.frames[frame]);
    let sum = |clip: usize, value: fn(&ForceRow) -> f64| -> [f64; 3] {
        let rows = found.forces.iter().filter(|row| row.frame == frame && row.clip == clip);
        rows.map(|row| row.world * value(row)).sum::<Vector3<f64>>().into()
    };
    let force = |(clip, at): (usize, &Vector3<f64>)| ClipForce {
        at: (*at).into(),
        measured: sum(clip, |row| row.measured),
        simulated: sum(clip, |row| row.simulated),
    };
    let pulls = |force: &ClipForce| force.measured != [0.0; 3] || force.simulated != [0.0; 3];
    centres.iter().enumerate().map(force).filter(pulls).collect()
}
