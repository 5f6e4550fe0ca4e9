//! Compares the table edge with the line where the sheet starts to hang.
//!
//! ```text
//! height  ●──●──●__                from the first two lines below the table:
//!                  ●               drop d = ½ κ (r − r₀)², so that √d is straight in r and zero at the edge r₀
//!                    ╲●
//! ```

use super::profile::{Line, profiles, up};
use crate::frame::{Fabric, Sequence};
use crate::measure::median;
use crate::notice::{Notice, Severity};

/// A line is below the table if it is lower by this many standard deviations of its mean and by at least 0.1 mm, the
/// flatness of a table.
const BELOW: f64 = 6.0;
const PLANE: f64 = 1e-4;

/// Rigidity scales with the cube of the overhang: an edge error of a tenth of it is an error of 30 %.
const REFUSED: f64 = 0.1;

/// An edge is misplaced if it is off by more than half the line spacing, which several frames resolve, and by more
/// than this, m.
const LEAST: f64 = 1e-3;

/// And by so many standard errors of the median over frames: a short overhang drops by little more than the noise.
const UNSURE: f64 = 3.0;

/// Largest height difference between flat cloth and edge, m, in addition to the thickness: tables and axes are
/// slightly off.
const LEVEL: f64 = 2e-3;

/// Standard error of a median, from the median deviation of its values; 0 of fewer than three.
fn standard_error(values: &[f64]) -> f64 {
    let Some(middle) = median(values.to_vec()).filter(|_| values.len() > 2) else { return 0.0 };
    let deviation = median(values.iter().map(|value| (value - middle).abs()).collect()).unwrap_or(0.0);
    // 1.4826 MAD is the standard deviation of normal values, √(π/2) σ/√n the standard error of their median.
    1.4826 * deviation * (0.5 * std::f64::consts::PI / values.len() as f64).sqrt()
}

/// Doubts or refuses a sequence whose sheet starts to hang away from the table edge, or does not lie on the table.
pub(super) fn check(fabric: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let Some(table) = sequence.table else { return };
    let Some(up) = up(&table, &sequence.gravity) else { return };
    let noise = sequence.position_noise();
    let (mut offs, mut lengths, mut levels, mut apart) = (Vec::new(), Vec::new(), Vec::new(), 0.0f64);
    for profile in profiles(sequence, &table, &up) {
        let Some(begin) = Begin::of(&profile.lines, noise) else { continue };
        offs.push(begin.outward);
        lengths.push(begin.length);
        levels.push(begin.level);
        apart = apart.max(begin.apart);
    }
    let frames = offs.len();
    let unsure = UNSURE * standard_error(&offs);
    let (Some(off), Some(length), Some(level)) = (median(offs), median(lengths), median(levels)) else {
        return;
    };
    if level.abs() > LEVEL + fabric.thickness_m.unwrap_or(0.0) {
        notices.push(Notice::doubt(
            &sequence.name,
            "test.toml table.edge_point_m",
            format!(
                "cloth that lies {:.1} mm {} the edge of its table (median of {frames} frames)",
                1e3 * level.abs(),
                if level > 0.0 { "above" } else { "below" }
            ),
            "an edge at the height of the cloth, in the axes of positions.npy",
        ));
    }
    if off.abs() <= f64::max(0.5 * apart, LEAST) + unsure {
        return;
    }
    let refused = off.abs() > REFUSED * length;
    let seen = if off < 0.0 { "below the table before its edge" } else { "flat past the table's edge" };
    notices.push(Notice::new(
        if refused { Severity::Refusal } else { Severity::Doubt },
        &sequence.name,
        "test.toml table.edge_point_m",
        format!(
            "cloth {seen}: it starts to hang {:.1} mm {} it (median of {frames} frames; lines of vertices are {:.1} mm \
             apart)",
            1e3 * off.abs(),
            if off < 0.0 { "before" } else { "past" },
            1e3 * apart
        ),
        format!(
            "an edge where the cloth starts to hang: {:.1} mm {} along outward, in the axes of positions.npy",
            1e3 * off.abs(),
            if off < 0.0 { "back" } else { "on" }
        ),
    ));
}

/// The start of the overhang.
struct Begin {
    /// Distance past the edge, m.
    outward: f64,
    /// Overhanging length, m.
    length: f64,
    /// Height of the flat part above the edge, m.
    level: f64,
    /// Line spacing there, m.
    apart: f64,
}

impl Begin {
    fn of(lines: &[Line], noise: f64) -> Option<Self> {
        // The lines farthest back define the level of the table.
        let back = &lines[..(lines.len() / 8).max(2).min(lines.len())];
        let level = median(back.iter().map(|line| line.height).collect())?;
        let below = |line: &Line| f64::max(BELOW * noise * line.error, PLANE) < level - line.height;
        // From the tip inward, so that a single low line on the table is ignored.
        let first = lines.iter().rposition(|line| !below(line))? + 1;
        let [flat, hanging] = [&lines[..first], &lines[first..]];
        let [a, b] = [hanging.first()?, hanging.get(1)?];
        let root = |line: &Line| (level - line.height).sqrt();
        let steeper = root(b) - root(a);
        if !(steeper > 0.0) {
            return None;
        }
        let begin = a.rest - root(a) * (b.rest - a.rest) / steeper;
        // Flat cloth keeps its rest distances, apart from the push.
        let pushed = median(flat.iter().map(|line| line.outward - line.rest).collect()).unwrap_or(f64::NAN);
        let last = hanging[hanging.len() - 1];
        Some(Self { outward: begin + pushed, length: last.rest - begin, level, apart: b.rest - a.rest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_is_as_sure_as_its_values_agree() {
        assert_eq!(standard_error(&[1.0, 2.0]), 0.0);
        assert_eq!(standard_error(&[3.0; 9]), 0.0);
        // 1.4826 × 1 × √(π/10)
        assert!((standard_error(&[1.0, 2.0, 3.0, 4.0, 5.0]) - 0.830_996).abs() < 1e-5);
    }
}
