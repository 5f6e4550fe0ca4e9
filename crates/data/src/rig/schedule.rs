//! Load schedule of a test: a list of steps, one per frame.

use crate::frame::Phase;

/// A planned frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// Drive of the test; 0 is the rest state. Each test defines its quantity.
    pub(super) drive: f64,
    /// Load cycle.
    pub(super) cycle: usize,
    /// Loading or unloading.
    pub(super) phase: Phase,
}

/// From rest to each end in turn and back, repeated for each cycle; loading and unloading have the same number of
/// steps. The first step is at rest.
pub(super) fn there_and_back(ends: &[f64], frames: usize, cycles: usize) -> Vec<Step> {
    let mut steps = vec![Step { drive: 0.0, cycle: 0, phase: Phase::Hold }];
    for cycle in 0..cycles {
        for end in ends {
            let at = |step: usize, phase| Step { drive: end * step as f64 / frames as f64, cycle, phase };
            steps.extend((1..=frames).map(|step| at(step, Phase::Loading)));
            steps.extend((0..frames).rev().map(|step| at(step, Phase::Unloading)));
        }
    }
    steps
}

/// Equal steps from one drive to another, both included.
pub(super) fn outward([first, last]: [f64; 2], frames: usize) -> Vec<Step> {
    let share = |step: usize| if frames == 1 { 1.0 } else { step as f64 / (frames - 1) as f64 };
    (0..frames)
        .map(|step| Step { drive: first + share(step) * (last - first), cycle: 0, phase: Phase::Loading })
        .collect()
}
