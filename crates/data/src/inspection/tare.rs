//! Forces on a sheet in a picture frame before shearing starts.

use crate::frame::{Clip, Fabric, Sequence};
use crate::kind::Holding;
use crate::measure::{clip_centres, mean};
use crate::notice::Notice;
use nalgebra::Vector3;

/// Clips are at rest if their distances differ from the rest state by less than this share of their largest change.
const REST: f64 = 1e-3;
/// Share of the largest force: cords have friction, and specimens are mounted with slight tension.
const SHARE: f64 = 0.1;
/// Number of standard deviations.
const SURE: f64 = 5.0;

/// Doubts a shear test whose cords pull before shearing starts.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    if sequence.kind.holding() != Holding::PictureFrame {
        return;
    }
    let sequence: &Sequence = sequence;
    let up = sequence.gravity.try_normalize(0.0).unwrap_or_default();
    // The force that carries the weight is not a tension.
    let in_plane = |force: Vector3<f64>| force - up * force.dot(&up);
    // Distances between clips do not depend on rigid motions.
    let apart = |centres: &[Vector3<f64>]| -> Vec<f64> {
        let pairs =
            centres.iter().enumerate().flat_map(|(i, a)| centres[..i].iter().map(move |b| (a - b).norm()));
        pairs.collect()
    };
    let held = |clip: &Clip| mean(clip.vertices.iter().map(|&vertex| sequence.mesh.positions[vertex]));
    let rest = apart(&sequence.clips.iter().map(held).collect::<Vec<_>>());
    let moved = |frame: usize| {
        let now = apart(&clip_centres(sequence, &sequence.frames[frame]));
        now.iter().zip(&rest).map(|(now, rest)| (now - rest).abs()).fold(0.0, f64::max)
    };
    let frames = 0..sequence.frames.len();
    let clips = 0..sequence.clips.len();
    let farthest = frames.clone().map(moved).fold(0.0, f64::max);
    let force = |frame: usize, clip: usize| Some(in_plane(sequence.frames[frame].clip_force(clip)?));
    let all = frames.clone().flat_map(|frame| clips.clone().filter_map(move |clip| force(frame, clip)));
    let largest = all.map(|force| force.norm()).fold(0.0, f64::max);
    let at_rest: Vec<usize> = frames.filter(|frame| moved(*frame) <= REST * farthest).collect();
    // Cord friction acts in opposite directions before and after a cycle.
    let tare = |clip| {
        let forces: Vec<Vector3<f64>> = at_rest.iter().filter_map(|frame| force(*frame, clip)).collect();
        Some((clip, mean(forces.iter().copied()).norm())).filter(|_| !forces.is_empty())
    };
    let Some((clip, force)) = clips.clone().filter_map(tare).max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return;
    };
    let noise = sequence.force_noise();
    if force <= f64::max(SURE * noise, SHARE * largest) {
        return;
    }
    let notice = Notice::doubt(
        &sequence.name,
        format!("forces.csv frame {}", at_rest.first().copied().unwrap_or(0)),
        format!("{force:.3} N on clip {} before the frame is sheared", sequence.clips[clip].name),
        format!(
            "none in the plane: load cells zeroed without load, and a tension of less than {:.0} % of the largest force, \
             {largest:.3} N",
            100.0 * SHARE
        ),
    );
    notices.push(notice);
}
