//! Compares clip poses with the vertices that the clips hold: position and distance moved.

use crate::frame::{Fabric, Sequence, is_seen};
use crate::measure::{mean, moved};
use crate::notice::Notice;
use nalgebra::Vector3;

/// Allowed distance in multiples of the coordinate noise: √3 is noise alone, and a pose has noise of its own.
const NOISE: f64 = 6.0;

/// Allowed distance as a share of the specimen size; less hardly changes a strain.
const SHARE: f64 = 2e-3;

/// One in so many of a clip's vertices may be mis-tracked: the farthest do not count.
const MISTRACKED: usize = 10;

/// Allowed relative difference between the clip motion in poses and in shapes, which changes no curve; a number of
/// standard deviations is allowed in addition.
const SAME_MOTION: f64 = 5e-3;
const SURE: f64 = 4.0;

/// Refuses a sequence in which the vertices of a clip were observed away from its poses. Doubts one in which they
/// moved farther, or less far, than the poses.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    notices.extend(elsewhere(sequence).or_else(|| motion(sequence)));
}

fn elsewhere(sequence: &Sequence) -> Option<Notice> {
    let noise = f64::max(sequence.position_noise(), sequence.clip_noise());
    let allowed = f64::max(NOISE * noise, SHARE * sequence.area().sqrt());
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
    let (frame, clip, apart) = worst?;
    Some(Notice::refusal(
        &sequence.name,
        "clips.csv against positions.npy",
        format!(
            "vertices of clip {} {:.2} mm (rms) from where its pose puts them in frame {frame}, and too far in {off} of {} \
             frames",
            sequence.clips[clip].name,
            1e3 * apart,
            sequence.frames.len()
        ),
        format!(
            "at most {:.2} mm: a pose maps rest points to where they are, x = R(q) x_rest + t, qw first, about the world's \
             origin; vertices hidden by a clip are NaN",
            1e3 * allowed
        ),
    ))
}

/// Ratio of the observed clip motion to that of the poses: the slope of one over the other through all frames.
fn motion(sequence: &Sequence) -> Option<Notice> {
    let [of_vertex, of_pose] = [sequence.position_noise(), sequence.clip_noise()].map(|noise| noise * noise);
    let (mut both, mut posed, mut variance) = (0.0, 0.0, 0.0);
    for clip in 0..sequence.clips.len() {
        let middles: Vec<_> = (0..sequence.frames.len()).filter_map(|i| middles(sequence, i, clip)).collect();
        let [seen, put] = [0, 1].map(|of| mean(middles.iter().map(|middle| middle.places[of])));
        for Middles { places, vertices } in &middles {
            let [seen, put] = [places[0] - seen, places[1] - put];
            both += seen.dot(&put);
            // Noise of a pose makes its motion longer.
            posed += put.norm_squared() - 3.0 * of_pose;
            variance += (of_vertex / *vertices as f64 + of_pose) * put.norm_squared();
        }
    }
    let off = both / posed - 1.0;
    (posed > 0.0 && off.abs() > f64::max(SAME_MOTION, SURE * variance.sqrt() / posed)).then(|| {
        Notice::doubt(
            &sequence.name,
            "clips.csv against positions.npy",
            format!(
                "clip vertices that moved {:.1} % {} than their poses",
                100.0 * off.abs(),
                if off > 0.0 { "farther" } else { "less far" }
            ),
            "the same scale: poses and shapes from one calibration, in metres",
        )
    })
}

/// Mean of a clip's vertices, as observed and as given by its pose.
struct Middles {
    places: [Vector3<f64>; 2],
    vertices: usize,
}

/// Over the observed vertices; `None` if there are none.
fn middles(sequence: &Sequence, frame: usize, clip: usize) -> Option<Middles> {
    let frame = &sequence.frames[frame];
    let (positions, pose) = (frame.positions.as_ref()?, frame.poses.get(clip)?);
    let held = sequence.clips[clip].vertices.iter().copied();
    let seen: Vec<usize> = held.filter(|&vertex| is_seen(&positions[vertex])).collect();
    let places = [
        mean(seen.iter().map(|&vertex| positions[vertex])),
        mean(seen.iter().map(|&vertex| moved(pose, &sequence.mesh.positions[vertex]))),
    ];
    (!seen.is_empty()).then_some(Middles { places, vertices: seen.len() })
}

/// Root mean square distance between the observed vertices of a clip, but the farthest, and its pose, m; `None` if none was
/// observed.
fn apart(sequence: &Sequence, frame: usize, clip: usize) -> Option<f64> {
    let frame = &sequence.frames[frame];
    let (positions, pose) = (frame.positions.as_ref()?, frame.poses.get(clip)?);
    let offsets = sequence.clips[clip]
        .vertices
        .iter()
        .map(|&vertex| -> Vector3<f64> { positions[vertex] - moved(pose, &sequence.mesh.positions[vertex]) });
    let mut squares: Vec<f64> =
        offsets.map(|offset| offset.norm_squared()).filter(|s| s.is_finite()).collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate(squares.len() - squares.len() / MISTRACKED);
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}
