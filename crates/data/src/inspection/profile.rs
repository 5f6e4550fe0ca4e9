//! Side view of a sheet on a table: lines along the edge, ordered from the rear line on the table to the tip.
//!
//! ```text
//!  height │ ●──●──●──●          a line is the mean of the vertices in a slice of the rest mesh
//!         │         ┃  ╲●
//!         └─────────┸────●───▶ outward
//! ```

use crate::frame::{Sequence, Table, is_seen};
use crate::measure::mean;
use nalgebra::{Matrix3, Vector3};

/// Minimum number of observed vertices in a slice.
const FEWEST: usize = 2;

/// A line of the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Rest distance from the rear side, m.
    pub(super) rest: f64,
    /// Distance past the edge, m; negative on the table.
    pub(super) outward: f64,
    /// Height above the edge, m.
    pub(super) height: f64,
    /// Standard deviation of its position, relative to that of a coordinate.
    pub(super) error: f64,
}

/// The side view of one frame.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Index of the frame.
    pub(super) frame: usize,
    /// Observed lines from the rear to the tip.
    pub(super) lines: Vec<Line>,
    /// Index of the first line past the edge; overhanging lines may swing back under the table.
    past: usize,
}

impl Profile {
    /// Lines on the table, and lines past its edge.
    pub(super) fn split(&self) -> [&[Line]; 2] {
        let (on, past) = self.lines.split_at(self.past);
        [on, past]
    }
}

/// Direction away from the table, against gravity; `None` if the component of gravity across the table is zero or
/// less than half.
pub(super) fn up(table: &Table, gravity: &Vector3<f64>) -> Option<Vector3<f64>> {
    let normal = Vector3::from(table.outward).cross(&Vector3::from(table.edge_direction)).normalize();
    let across = normal.dot(gravity);
    (across.abs() > 0.5 * gravity.norm()).then(|| normal * -across.signum())
}

/// Profiles of all frames with observed lines.
pub(super) fn profiles(sequence: &Sequence, table: &Table, up: &Vector3<f64>) -> Vec<Profile> {
    let [edge, outward] = [table.edge_point_m, table.outward].map(Vector3::from);
    let Some(reach) = reach(sequence, &outward) else { return Vec::new() };
    let length = reach.iter().copied().fold(0.0, f64::max);
    let slices = (length / (sequence.area() / reach.len() as f64).sqrt()).round().max(1.0);
    let profile = |(frame, positions): (usize, &Vec<Vector3<f64>>)| {
        let mut of: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); slices as usize + 1];
        for (&reach, place) in reach.iter().zip(positions).filter(|(_, place)| is_seen(place)) {
            let from_edge = place - edge;
            let slice = (slices * reach / length).round() as usize;
            of[slice].push(Vector3::new(reach, from_edge.dot(&outward), from_edge.dot(up)));
        }
        let line = |slice: Vec<Vector3<f64>>| {
            let (error, middle) = (1.0 / (slice.len() as f64).sqrt(), mean(slice.into_iter()));
            Line { rest: middle.x, outward: middle.y, height: middle.z, error }
        };
        let lines: Vec<Line> = of.into_iter().filter(|slice| slice.len() >= FEWEST).map(line).collect();
        let past = lines.iter().position(|line| line.outward > 0.0).unwrap_or(lines.len());
        Profile { frame, lines, past }
    };
    shapes(sequence).map(profile).filter(|profile| profile.lines.len() > 1).collect()
}

/// Rest distance of every vertex from the rear side of the sheet over all frames, m.
fn reach(sequence: &Sequence, outward: &Vector3<f64>) -> Option<Vec<f64>> {
    let rest = &sequence.mesh.positions;
    let along = outward_at_rest(sequence, outward)?;
    let back = rest.iter().map(|rest| rest.dot(&along)).fold(f64::MAX, f64::min);
    Some(rest.iter().map(|rest| rest.dot(&along) - back).collect())
}

/// Direction in the rest mesh that points outward on average over all frames, whichever part of the sheet was
/// observed; unit length.
pub(super) fn outward_at_rest(sequence: &Sequence, outward: &Vector3<f64>) -> Option<Vector3<f64>> {
    let rest = &sequence.mesh.positions;
    let (mut along, mut spread) = (Vector3::zeros(), Matrix3::zeros());
    for (_, positions) in shapes(sequence) {
        let seen = || rest.iter().zip(positions).filter(|(_, place)| is_seen(place));
        let middle = mean(seen().map(|(rest, _)| *rest));
        for (rest, place) in seen() {
            along += (rest - middle) * place.dot(outward);
            spread += (rest - middle) * (rest - middle).transpose();
        }
    }
    // The rest mesh is flat.
    let inverse = spread.pseudo_inverse(1e-9 * spread.trace()).ok()?;
    (inverse * along).try_normalize(0.0)
}

/// Measured shapes with the indices of their frames.
fn shapes(sequence: &Sequence) -> impl Iterator<Item = (usize, &Vec<Vector3<f64>>)> {
    let frames = sequence.frames.iter().enumerate();
    frames.filter_map(|(index, frame)| Some((index, frame.positions.as_ref()?)))
}
