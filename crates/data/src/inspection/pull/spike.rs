//! Readings far from those before and after.

use super::reading::{NOISE, Pull, digits};
use crate::measure::median;
use crate::notice::{Notice, Remedy, Severity};
use std::ops::Range;

/// Number of readings on each side used for comparison.
const NEIGHBOURS: usize = 3;
/// A spike deviates by this many times the 90th percentile of the steps between readings. A strip pulled stepwise
/// overshoots and relaxes by about one.
const STEPS: f64 = 4.0;
/// Multiple of the noise threshold that a spike must exceed too.
const CLEAR: f64 = 4.0;

/// Indices of the spikes, ascending.
pub(super) fn find(pull: &Pull) -> Vec<usize> {
    pull.branches().into_iter().flat_map(|branch| of_branch(pull, branch)).collect()
}

fn of_branch(pull: &Pull, branch: Range<usize>) -> Vec<usize> {
    let forces: Vec<f64> = pull.readings[branch.clone()].iter().map(|reading| reading.force).collect();
    // With fewer readings a third may be bad, which spoils the median.
    if forces.len() < 2 * NEIGHBOURS + 1 {
        return Vec::new();
    }
    let mut steps: Vec<f64> = forces.windows(2).map(|two| (two[1] - two[0]).abs()).collect();
    let large = steps.len() * 9 / 10;
    let large = *steps.select_nth_unstable_by(large, f64::total_cmp).1;
    let limit = (CLEAR * NOISE * pull.noise).max(STEPS * large);
    let is_spike = |&row: &usize| {
        let near = &forces[row.saturating_sub(NEIGHBOURS)..(row + NEIGHBOURS + 1).min(forces.len())];
        let off = forces[row] - median(near.to_vec()).unwrap_or(0.0);
        // Where a strip locks, readings are far apart too, but monotonic.
        let in_order = (forces[row] - near[0]) * (near[near.len() - 1] - forces[row]) > 0.0;
        off.abs() > limit && !in_order
    };
    // The ends of a branch have neighbours on one side only, and a strip may break there.
    (1..forces.len() - 1).filter(is_spike).map(|row| branch.start + row).collect()
}

/// The notice that lists them.
pub(super) fn notice(pull: &Pull, spikes: &[usize]) -> Option<Notice> {
    let (&first, others) = spikes.split_first()?;
    let reading = &pull.readings[first];
    let others = match others {
        [] => String::new(),
        others => {
            let numbers: Vec<_> = others.iter().map(|&row| pull.readings[row].number.to_string()).collect();
            format!(", and likewise at {}", crate::io::shortened(&numbers.join(", "), 60))
        }
    };
    let found = format!("{} N far off the readings before and after{others}", digits(reading.force, 4));
    let expected = "neighbours that agree: leave such readings out of the table, or use a robust fit, in which \
                    they hardly count";
    Some(pull.notice(Severity::Doubt, reading, found, expected.into()).with(vec![Remedy::Robust]))
}
