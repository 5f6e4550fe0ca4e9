//! Step-by-step check: the change of force against the direction of the clips.
//!
//! ```text
//!  force      ╱╲  ╱   slip: it falls      ╱ ╱  set back: it rises      ____ the load cell's end:
//!           ╱    ╲    though the strip  ╱ ╱    though the clips      ╱      it stands still
//!         ╱           gets longer       ╱      go back             ╱
//! ```

use super::reading::{NOISE, Pull, Reading, digits, noise};
use crate::measure::median;
use crate::notice::{Notice, Severity};
use std::collections::BTreeMap;

/// Shares of the largest force, lost while the clips move apart and gained while they move back. Single broken yarns
/// and pauses of a manual pull lose less.
const LOST: f64 = 0.04;
const GAINED: f64 = 0.005;
/// Shares of a usual clip step: below the first the clips stand still and the force relaxes; above the second they
/// move.
const STILL: f64 = 0.1;
const GOING: f64 = 0.5;
/// Number of identical readings, to the last digit, that cannot be chance.
const ALIKE: usize = 3;

/// Reports the first of each kind.
pub(super) fn check(pull: &Pull) -> Vec<Notice> {
    if !pull.is_in_order() {
        return Vec::new();
    }
    let steps = pull.readings.windows(2).map(|two| (two[1].separation - two[0].separation).abs());
    let usual = median(steps.filter(|step| *step > 0.0).collect()).unwrap_or(0.0);
    let moves = |share: f64| f64::max(share * usual, NOISE * pull.step_noise);
    let (still, going) = (moves(STILL), moves(GOING));
    let rises = pull.readings.windows(2).map(|two| (two[1].force - two[0].force).abs());
    let rise = median(rises.collect()).unwrap_or(0.0);
    // A branch may be rougher than most, for example the first pull of a new strip.
    let branches = pull.readings.chunk_by(|a, b| a.branch == b.branch);
    let rough: BTreeMap<usize, f64> =
        branches.map(|branch| (branch[0].branch, noise(branch).max(pull.noise))).collect();
    let least = |share: f64, branch: usize| (2.0 * NOISE * rough[&branch]).max(share * pull.largest_force());
    let slip = (1..pull.readings.len()).find(|&row| {
        let [a, b] = [row - 1, row].map(|row| &pull.readings[row]);
        // The clips pause before they reverse.
        let goes_on = pull.readings.get(row + 1).is_none_or(|c| c.separation - b.separation > going);
        // A drop back from a single high reading is not a loss.
        let before = row.checked_sub(2).map_or(f64::MAX, |row| pull.readings[row].force);
        let lost = a.force.min(before + 2.0 * rise) - b.force;
        b.separation - a.separation > going && lost > least(LOST, a.branch) && goes_on
    });
    let back = (1..pull.readings.len()).find(|&row| {
        let [a, b] = [row - 1, row].map(|row| &pull.readings[row]);
        a.separation - b.separation > still && b.force - a.force > least(GAINED, a.branch)
    });
    let [slip, back] = [slip, back].map(|row| row.map(|row| (&pull.readings[row - 1], &pull.readings[row])));
    let tell = |(a, b): (&Reading, &Reading), what: &str, expected: &str| {
        let found = format!(
            "{} N with the clamps {:.2} mm apart, then {} N at {:.2} mm: {what}",
            digits(a.force, 3),
            1e3 * a.separation,
            digits(b.force, 3),
            1e3 * b.separation
        );
        pull.notice(Severity::Doubt, b, found, expected.into())
    };
    let slip = slip.map(|pair| {
        tell(
            pair,
            "the strip slipped, yarns broke, or it relaxed while the pull paused",
            "force that rises while the strip gets longer: use the rows up to there",
        )
    });
    let back = back.map(|pair| {
        tell(
            pair,
            "was the extension reset?",
            "force that falls while the clamps move back: an extension zeroed only once",
        )
    });
    slip.into_iter().chain(back).chain(saturated(pull, still)).collect()
}

/// The largest force, read repeatedly although the strip gets longer.
fn saturated(pull: &Pull, still: f64) -> Option<Notice> {
    let largest = pull.readings.iter().map(|reading| reading.force).fold(f64::MIN, f64::max);
    let mut runs = pull.readings.chunk_by(|a, b| a.force == b.force && b.separation - a.separation > still);
    let run = runs.find(|run| run.len() >= ALIKE && run[0].force == largest)?;
    let found = format!("{} N in {} readings, although the strip gets longer", digits(largest, 4), run.len());
    let expected = "force that rises: if the load cell reached its limit, use the rows up to there";
    Some(pull.notice(Severity::Doubt, &run[0], found, expected.into()))
}
