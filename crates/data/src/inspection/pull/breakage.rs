//! Detects breakage or slip in the clips: the force drops while the strip gets longer.

use super::reading::{NOISE, Pull, Reading, digits};
use crate::notice::{Notice, Severity};

/// Share of the force that counts as lost while the clips move apart. Yarns that break one by one before the strip
/// lose less.
const LOST: f64 = 0.15;
/// While the clips stand still the force relaxes, but never by this share.
const RELAXED: f64 = 0.5;
/// Share of a mean clip step below which the clips stand still.
const STILL: f64 = 0.1;
/// Minimum number of readings of a loading.
const FEW: usize = 4;

/// The last reading before the breakage and the first after it.
pub(super) struct Breakage {
    /// Reading with the largest force; later ones are unusable.
    pub(super) last: usize,
    /// First reading with the reduced force.
    fallen: usize,
}

/// Finds the first loading that ends in a breakage.
pub(super) fn find(pull: &Pull) -> Option<Breakage> {
    if !pull.is_in_order() {
        return None;
    }
    pull.branches().into_iter().find_map(|branch| {
        let start = branch.start;
        let Breakage { last, fallen } = of_loading(&pull.readings[branch], pull)?;
        Some(Breakage { last: start + last, fallen: start + fallen })
    })
}

fn of_loading(readings: &[Reading], pull: &Pull) -> Option<Breakage> {
    let [first, _, .., end] = readings else { return None };
    let step = (end.separation - first.separation) / (readings.len() - 1) as f64;
    // Drops within noise or slack do not count.
    let least = (2.0 * NOISE * pull.noise).max(0.05 * pull.largest_force());
    // A peak needs two readings. `expected` is the force without relaxation since the peak.
    let held = |row: usize| readings[row].force.min(readings[row - 1].force);
    let (mut peak, mut expected) = (1, held(1));
    for row in 2..readings.len() {
        let (before, now) = (&readings[row - 1], &readings[row]);
        if now.separation - before.separation <= STILL * step {
            expected -= (before.force - now.force).max(0.0);
        }
        let largest = held(peak);
        if held(row) >= largest {
            (peak, expected) = (row, held(row));
            continue;
        }
        let lost = expected - now.force > LOST * largest || largest - now.force > RELAXED * largest;
        let longer = now.separation - readings[peak].separation > STILL * step;
        // A force that recovers at once indicates a bad reading.
        let regained = readings[row + 1..].iter().take(2).any(|later| later.force >= largest);
        if peak >= FEW && lost && longer && largest - now.force > least && !regained {
            return Some(Breakage { last: peak, fallen: row });
        }
    }
    None
}

impl Breakage {
    /// The notice.
    pub(super) fn notice(&self, pull: &Pull) -> Notice {
        let [last, fallen] = [self.last, self.fallen].map(|row| &pull.readings[row]);
        let found = format!(
            "{} N with the clamps {:.2} mm apart, then {} N while the strip gets longer: it broke or slipped",
            digits(last.force, 3),
            1e3 * last.separation,
            digits(fallen.force, 3),
        );
        let expected = "force that rises: later readings are left out".into();
        pull.notice(Severity::Remark, last, found, expected)
    }
}
