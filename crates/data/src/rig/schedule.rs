//! In which order a test goes where: its steps, one a frame.

use crate::frame::Phase;

/// One frame to come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// How far the test is driven; 0 is at rest. What it measures is the test's own affair.
    pub(super) drive: f64,
    /// Which load cycle.
    pub(super) cycle: usize,
    /// Loading or unloading.
    pub(super) phase: Phase,
}

/// From rest to each of the ends in turn and back, in as many steps out as back, as often as there are
/// cycles. The first step is at rest.
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

/// From one drive to another, both included, in equal steps.
pub(super) fn outward([first, last]: [f64; 2], frames: usize) -> Vec<Step> {
    let share = |step: usize| if frames == 1 { 1.0 } else { step as f64 / (frames - 1) as f64 };
    (0..frames)
        .map(|step| Step { drive: first + share(step) * (last - first), cycle: 0, phase: Phase::Loading })
        .collect()
}
