//! Compares the yarn direction of an overhanging sheet with the kind of its test.

use super::profile::outward_at_rest;
use crate::frame::{Fabric, Sequence, is_seen};
use crate::measure::affine_map;
use crate::notice::Notice;
use nalgebra::Vector3;

/// Allowed misalignment of cutting and placing, °.
const STRAIGHT: f64 = 15.0;

/// Minimum number of vertices, over all frames, that determine a direction.
const FEWEST: usize = 20;

/// Refuses a bending test whose sheet hangs along other yarns than its kind states.
pub(super) fn check(_: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(table) = sequence.table else { return };
    let expected = sequence.kind.degrees_from_weft();
    let name = match expected {
        0.0 => "weft",
        90.0 => "warp",
        _ => "the bias",
    };
    let Some(angle) = angle_from_weft(sequence, &Vector3::from(table.outward)) else { return };
    if (angle - expected).abs() <= STRAIGHT {
        return;
    }
    notices.push(Notice::refusal(&sequence.name, "test.toml kind", format!("{}, and shapes that hang over at {angle:.0}° to weft", sequence.kind), format!(
            "{expected:.0}°, along {name}: the kind, vt of mesh.obj (u along weft), table.outward, or the order of the vertices \
             in positions.npy"
        )));
}

/// Angle between weft and the direction of the rest mesh that points outward, 0 to 90°.
fn angle_from_weft(sequence: &Sequence, outward: &Vector3<f64>) -> Option<f64> {
    let seen = sequence
        .frames
        .iter()
        .filter_map(|frame| frame.positions.as_ref())
        .flatten()
        .filter(|place| is_seen(place));
    if seen.count() < FEWEST {
        return None;
    }
    let along = outward_at_rest(sequence, outward)?;
    let map = affine_map(&sequence.mesh.material, &sequence.mesh.positions)?;
    let material = (map.transpose() * map).try_inverse()? * map.transpose() * along;
    Some(material.y.abs().atan2(material.x.abs()).to_degrees())
}
