//! Missing shapes, or shapes with constant height, as recorded by a camera without depth.

use crate::frame::{Fabric, HEIGHT_SEEN, Sequence, is_seen};
use crate::kind::Holding;
use crate::notice::Notice;
use nalgebra::Vector3;

/// Refuses a bending test without shapes.
pub(super) fn check_presence(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    if sequence.table.is_none() || sequence.frames.iter().any(|frame| frame.positions.is_some()) {
        return;
    }
    notices.push(Notice::refusal(
        &sequence.name,
        "positions.npy",
        "nothing",
        "the measured shapes, there or in frames/: a bending test requires them",
    ));
}

/// Reports a sheared sheet whose shapes cannot show whether it buckled.
pub(super) fn check_heights(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let places = sequence.frames.iter().flat_map(|frame| &frame.positions).flatten();
    let seen: Vec<&Vector3<f64>> = places.filter(|place| is_seen(place)).collect();
    let alike = |axis: &usize| seen.iter().all(|place| (place[*axis] - seen[0][*axis]).abs() <= HEIGHT_SEEN);
    if sequence.kind.holding() != Holding::PictureFrame || seen.is_empty() || !(0..3).any(|axis| alike(&axis))
    {
        return;
    }
    notices.push(Notice::remark(
        &sequence.name,
        "positions.npy",
        "the same height for every vertex in every frame: it was not measured",
        "measured heights, which show whether the sheet buckled: it is fitted as if no shapes were measured",
    ));
}
