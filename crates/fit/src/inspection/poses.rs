//! Poses of clips against the vertices that they hold.

use super::{Notice, Severity, area, position_noise};
use crate::frame::{Fabric, Sequence};
use crate::measure::moved;
use nalgebra::Vector3;

/// Vertices may be seen so many times the noise of a coordinate away: √3 is noise itself, and a pose has some too.
const NOISE: f64 = 6.0;

/// And by this share of the specimen's size: less changes a strain by little.
const SHARE: f64 = 2e-3;

/// Refuses a sequence in which a clip's vertices were seen elsewhere than its poses put them.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let allowed = f64::max(NOISE * position_noise(sequence), SHARE * area(sequence).sqrt());
    let mut worst: Option<(usize, usize, f64)> = None;
    let mut off = 0;
    for index in 0..sequence.frames.len() {
        let clips = (0..sequence.clips.len()).filter_map(|clip| Some((clip, apart(sequence, index, clip)?)));
        let Some((clip, apart)) =
            clips.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, apart)| *apart > allowed)
        else {
            continue;
        };
        off += 1;
        if worst.is_none_or(|(_, _, most)| apart > most) {
            worst = Some((index, clip, apart));
        }
    }
    let Some((frame, clip, apart)) = worst else { return };
    notices.push(Notice {
        severity: Severity::Refusal,
        sequence: sequence.name.clone(),
        place: "clips.csv against positions.npy".into(),
        found: format!(
            "vertices of clip {} {:.2} mm (rms) from where its pose puts them in frame {frame}, and too far in {off} of {} \
             frames",
            sequence.clips[clip].name,
            1e3 * apart,
            sequence.frames.len()
        ),
        expected: format!(
            "at most {:.2} mm: a pose maps rest points to where they are, x = R(q) x_rest + t, qw first, about the world's \
             origin; vertices hidden by a clip are NaN",
            1e3 * allowed
        ),
    });
}

/// Root mean square distance of a clip's vertices, as seen, from where its pose puts them, m; `None` where none was seen.
fn apart(sequence: &Sequence, frame: usize, clip: usize) -> Option<f64> {
    let frame = &sequence.frames[frame];
    let (positions, pose) = (frame.positions.as_ref()?, frame.poses.get(clip)?);
    let offsets = sequence.clips[clip]
        .vertices
        .iter()
        .map(|&vertex| -> Vector3<f64> { positions[vertex] - moved(pose, &sequence.mesh.positions[vertex]) });
    let squares: Vec<f64> = offsets.map(|offset| offset.norm_squared()).filter(|s| s.is_finite()).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}
