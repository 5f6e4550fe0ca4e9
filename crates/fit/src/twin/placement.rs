//! Placement of a test: the rest mesh may lie anywhere, and the clips' poses move it from there.
//!
//! ```text
//!   ╱╲  rest         the frame that deforms the clips' places least: rest ── nearest rigid motion ──▶ where it is held
//!  ╱  ╲    ──▶   ┌──┐
//!  ╲  ╱          │  │      all that is said of the plane of a test is said of this one
//!   ╲╱           └──┘
//! ```

use cloth_data::frame::{Frame, Sequence};
use cloth_data::measure::moved;
use cloth_data::rectangle::FLAT_SLOPE;
use cloth_sim::rigid::nearest_motion;
use nalgebra::{Isometry3, Vector3};
use std::borrow::Cow;

/// The sequence with its rest mesh moved rigidly to its clips, and poses relative to that. Unchanged without clips,
/// or if it lies there already within the tolerance of flatness.
pub(crate) fn in_place(sequence: &Sequence) -> Cow<'_, Sequence> {
    let Some(motion) = clips_motion(sequence) else { return Cow::Borrowed(sequence) };
    let mut placed = sequence.clone();
    placed.mesh.positions.iter_mut().for_each(|rest| *rest = moved(&motion, rest));
    let back = motion.inverse();
    placed.frames.iter_mut().flat_map(|frame| &mut frame.poses).for_each(|pose| *pose *= back);
    Cow::Owned(placed)
}

/// The rigid motion of all clips together in the frame that deforms them least; `None` if negligible.
fn clips_motion(sequence: &Sequence) -> Option<Isometry3<f64>> {
    let pairs = |frame: &Frame| -> Vec<[Vector3<f64>; 2]> {
        let clips = sequence.clips.iter().zip(&frame.poses);
        let rest = clips.flat_map(|(clip, pose)| clip.vertices.iter().map(move |&vertex| (vertex, pose)));
        rest.map(|(vertex, pose)| (sequence.mesh.positions[vertex], pose))
            .map(|(p, pose)| [p, moved(pose, &p)])
            .collect()
    };
    let motions = sequence.frames.iter().map(|frame| {
        let pairs = pairs(frame);
        let motion = nearest_motion(&pairs);
        let left: f64 = pairs.iter().map(|[rest, now]| (now - moved(&motion, rest)).norm_squared()).sum();
        (motion, left)
    });
    let (motion, _) = motions.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let held = || sequence.clips.iter().flat_map(|clip| &clip.vertices).map(|&v| sequence.mesh.positions[v]);
    let first = held().next()?;
    let size = held().map(|rest| (rest - first).norm()).fold(0.0, f64::max);
    let far = held().map(|rest| (moved(&motion, &rest) - rest).norm()).fold(0.0, f64::max);
    (far > FLAT_SLOPE * size).then_some(motion)
}
