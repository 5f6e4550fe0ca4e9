//! Profiles of a sheet across a table's edge, measured and simulated.

use super::place::vector;
use cloth_data::frame::Sequence;
use cloth_data::measure::bend_profile;
use cloth_fit::stage::shapes::{FrameShape, Place, Shapes};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Profile of one frame: distance beyond the edge and height, m; `None` where no node of a line was observed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Profile {
    pub(crate) frame: usize,
    pub(crate) measured: Vec<[Option<f64>; 2]>,
    pub(crate) simulated: Vec<[Option<f64>; 2]>,
}

/// One profile per frame; empty for a sequence without a table.
pub(crate) fn profiles(sequence: &Sequence, shapes: &Shapes) -> Vec<Profile> {
    let Some(table) = &sequence.table else { return Vec::new() };
    let across = |places: &[Place]| -> Vec<[Option<f64>; 2]> {
        let positions: Vec<Vector3<f64>> = places.iter().map(|place| vector(*place)).collect();
        let known = |value: f64| Some(value).filter(|value| value.is_finite());
        let profile = bend_profile(&shapes.grid, &positions, table, &sequence.gravity);
        profile.iter().map(|point| [known(point.outward), known(point.height)]).collect()
    };
    let profile = |frame: &FrameShape| Profile {
        frame: frame.frame,
        measured: if frame.measured.is_empty() { Vec::new() } else { across(&frame.measured) },
        simulated: across(&frame.simulated),
    };
    shapes.frames.iter().map(profile).collect()
}
