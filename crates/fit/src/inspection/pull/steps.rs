//! From one reading to the next: force against the way the clips went.
//!
//! ```text
//!  force      ╱╲  ╱   slip: it falls      ╱ ╱  set back: it rises      ____ the load cell's end:
//!           ╱    ╲    though the strip  ╱ ╱    though the clips      ╱      it stands still
//!         ╱           gets longer       ╱      go back             ╱
//! ```

use super::{NOISE, Notice, Pull, Reading, Severity, digits, median};

/// Of the largest force: what yarns lose one by one is less, and what is gained on the way back.
const LOST: f64 = 0.02;
const GAINED: f64 = 0.005;
/// Of a usual step of the clips: less is standing still.
const STILL: f64 = 0.1;
/// So many readings that are the same to the last digit are no chance.
const ALIKE: usize = 3;

/// Tells of the first of each kind.
pub(super) fn check(pull: &Pull) -> Vec<Notice> {
    if !pull.is_in_order() {
        return Vec::new();
    }
    let steps = pull.readings.windows(2).map(|two| (two[1].separation - two[0].separation).abs());
    let still = STILL * median(steps.filter(|step| *step > 0.0).collect()).unwrap_or(0.0);
    let least = |share: f64| (2.0 * NOISE * pull.noise).max(share * pull.largest_force());
    let two = |is_meant: &dyn Fn(f64, f64) -> bool| {
        let mut pairs = pull.readings.windows(2).map(|two| (&two[0], &two[1]));
        pairs.find(|(a, b)| is_meant(b.separation - a.separation, b.force - a.force))
    };
    let slip = two(&|longer, rise| longer > still && rise < -least(LOST));
    let back = two(&|longer, rise| longer < -still && rise > least(GAINED));
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
            "the strip slipped, or yarns broke",
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
