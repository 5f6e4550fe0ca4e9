//! Where a strip breaks, or slips in its clips: the force falls while it gets longer.

use super::reading::{NOISE, Pull, Reading, digits};
use crate::notice::{Notice, Severity};

/// A force has fallen if so large a share of it is lost while the clips move apart. Yarns that break one by one, before the
/// strip does, lose less.
const LOST: f64 = 0.15;
/// If they stand still it relaxes, but never by so much.
const RELAXED: f64 = 0.5;
/// Of a mean step of the clips: less is standing still.
const STILL: f64 = 0.1;
/// A loading has so many readings before it is worth judging.
const FEW: usize = 4;

/// The last reading before it, and the first after.
pub(super) struct Breakage {
    /// The reading with the largest force; none beyond it is of use.
    pub(super) last: usize,
    /// The first reading by which the force has fallen.
    fallen: usize,
}

/// The first loading that ends so.
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
    // What noise and slack do is no fall.
    let least = (2.0 * NOISE * pull.noise).max(0.05 * pull.largest_force());
    // One reading alone is no peak. What the force would be without relaxing since the peak.
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
        // A force that is back at once was a bad reading.
        let regained = readings[row + 1..].iter().take(2).any(|later| later.force >= largest);
        if peak >= FEW && lost && longer && largest - now.force > least && !regained {
            return Some(Breakage { last: peak, fallen: row });
        }
    }
    None
}

impl Breakage {
    /// Tells of it.
    pub(super) fn notice(&self, pull: &Pull) -> Notice {
        let [last, fallen] = [self.last, self.fallen].map(|row| &pull.readings[row]);
        let found = format!(
            "{} N with the clamps {:.2} mm apart, and then {} N while the strip gets longer: it broke, or slipped",
            digits(last.force, 3),
            1e3 * last.separation,
            digits(fallen.force, 3),
        );
        let expected = "force that rises: what follows is left out".into();
        pull.notice(Severity::Remark, last, found, expected)
    }
}
