//! From one reading to the next: force against the way the clips went.
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

/// Of the largest force: what yarns lose one by one, and what a strip pulled by hand loses where the hand rests, is less; and
/// what is gained on the way back.
const LOST: f64 = 0.04;
const GAINED: f64 = 0.005;
/// Of a usual step of the clips: less is standing still, where force relaxes; more is going on.
const STILL: f64 = 0.1;
const GOING: f64 = 0.5;
/// So many readings that are the same to the last digit are no chance.
const ALIKE: usize = 3;

/// Tells of the first of each kind.
pub(super) fn check(pull: &Pull) -> Vec<Notice> {
    if !pull.is_in_order() {
        return Vec::new();
    }
    let steps = pull.readings.windows(2).map(|two| (two[1].separation - two[0].separation).abs());
    let usual = median(steps.filter(|step| *step > 0.0).collect()).unwrap_or(0.0);
    let (still, going) = (STILL * usual, GOING * usual);
    let rises = pull.readings.windows(2).map(|two| (two[1].force - two[0].force).abs());
    let rise = median(rises.collect()).unwrap_or(0.0);
    // A branch may be rougher than most: a strip that is pulled for the first time.
    let branches = pull.readings.chunk_by(|a, b| a.branch == b.branch);
    let rough: BTreeMap<usize, f64> =
        branches.map(|branch| (branch[0].branch, noise(branch).max(pull.noise))).collect();
    let least = |share: f64, branch: usize| (2.0 * NOISE * rough[&branch]).max(share * pull.largest_force());
    let slip = (1..pull.readings.len()).find(|&row| {
        let [a, b] = [row - 1, row].map(|row| &pull.readings[row]);
        // Before clips turn they rest.
        let goes_on = pull.readings.get(row + 1).is_none_or(|c| c.separation - b.separation > going);
        // What falls back from one high reading has lost nothing.
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
            "{} N with the clamps {:.2} mm apart, and then {} N at {:.2} mm: {what}",
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
            "force that rises while a strip gets longer: rows up to there",
        )
    });
    let back = back.map(|pair| {
        tell(
            pair,
            "was the extension set back?",
            "force that falls where the clamps go back: one extension, set to zero once",
        )
    });
    slip.into_iter().chain(back).chain(saturated(pull, still)).collect()
}

/// Where the largest force is read again and again, though the strip gets longer.
fn saturated(pull: &Pull, still: f64) -> Option<Notice> {
    let largest = pull.readings.iter().map(|reading| reading.force).fold(f64::MIN, f64::max);
    let mut runs = pull.readings.chunk_by(|a, b| a.force == b.force && b.separation - a.separation > still);
    let run = runs.find(|run| run.len() >= ALIKE && run[0].force == largest)?;
    let found = format!("{} N in {} readings, though the strip gets longer", digits(largest, 4), run.len());
    let expected = "force that rises: was that all that the load cell can read? then rows up to there";
    Some(pull.notice(Severity::Doubt, &run[0], found, expected.into()))
}
