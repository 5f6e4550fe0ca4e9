//! Checks of a pulled strip from clip forces and clip distance alone, without simulation.
//!
//! ```text
//! force                    ╱│ spike: one reading off its neighbours
//!   │                    ╱  │
//!   │      rest        ╱    ╲ breakage: it falls while the strip gets longer
//!   │ slack, tension, ╱
//!   │ zero off   ___╱           magnitude: N/m plausible for cloth?
//!   └──────────────────────── separation of the clips
//! ```

mod breakage;
mod magnitude;
mod polynomial;
mod reading;
mod rest;
mod spike;
mod steps;
#[cfg(test)]
mod tests;
mod toe;

use crate::frame::{Fabric, Sequence};
use crate::notice::Notice;
use reading::{Pull, noise, points};

pub(crate) use reading::Reading;

pub(super) fn check(fabric: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let numbers: Vec<usize> = (0..sequence.frames.len()).collect();
    notices.extend(inspect(sequence, Some(fabric.areal_density_kg_m2), "forces.csv frame", &numbers));
}

/// Drops the frames after a breakage and reports every notice.
///
/// * `areal_density` — kg/m²; given, the magnitude of the forces is checked too
/// * `counted` — meaning of the frame numbers, e.g. `forces.csv frame`
/// * `numbers` — one per frame
pub(crate) fn inspect(
    sequence: &mut Sequence,
    areal_density: Option<f64>,
    counted: &str,
    numbers: &[usize],
) -> Vec<Notice> {
    let Some(mut pull) = Pull::of(sequence, counted, numbers) else { return Vec::new() };
    let mut notices = Vec::new();
    let spikes = spike::find(&pull);
    notices.extend(spike::notice(&pull, &spikes));
    // A single bad reading must not pass for a breakage or a preload.
    pull.leave_out(&spikes);
    if let Some(breakage) = breakage::find(&pull) {
        let last = pull.readings[breakage.last].number;
        notices.push(breakage.notice(&pull));
        pull.readings.truncate(breakage.last + 1);
        sequence.frames.truncate(numbers.iter().take_while(|&&number| number <= last).count());
    }
    notices.extend(steps::check(&pull));
    notices.extend(rest::check(&pull));
    notices.extend(areal_density.and_then(|density| magnitude::check(&pull, density)));
    notices
}

/// Free length of a strip, m: where a loading, extrapolated from a given force, reaches zero; `None` if it does not.
///
/// * `force` — N
pub(crate) fn free_length(loading: &[Reading], force: f64) -> Option<f64> {
    toe::free_length(&points(loading), force, noise(loading))
}
