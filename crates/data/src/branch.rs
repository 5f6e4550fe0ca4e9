//! Branches of a cyclic test: split where the moving clamp reverses.

use crate::frame::Phase;
use std::collections::BTreeMap;

/// Share of the extension range by which the clamp must move back to count as a reversal; smaller reversals are
/// noise.
const HYSTERESIS: f64 = 0.02;

/// Branch of every row, counted from 0. A turning point is the last row of the branch that leads to it.
pub(crate) fn numbered(extension: &[f64]) -> Vec<usize> {
    let threshold = threshold(extension.iter().copied());
    let mut turns = Vec::new();
    // Rows of the lowest and highest extension since the last reversal, and the direction, unknown at first.
    let (mut low, mut high, mut rises) = (0, 0, None);
    for (row, &value) in extension.iter().enumerate() {
        // A plateau belongs to the branch that led to it.
        if value <= extension[low] {
            low = row;
        }
        if value >= extension[high] {
            high = row;
        }
        let (rise, fall) = (value - extension[low] > threshold, extension[high] - value > threshold);
        let turn = match rises {
            None if rise || fall => {
                rises = Some(rise);
                None
            }
            Some(true) if fall => Some(high),
            Some(false) if rise => Some(low),
            _ => None,
        };
        if let Some(turn) = turn {
            turns.push(turn);
            (low, high, rises) = (row, row, rises.map(|rises| !rises));
        }
    }
    (0..extension.len()).map(|row| turns.partition_point(|&turn| turn < row)).collect()
}

/// Phase of every branch: loading or unloading if its end lies so far above or below its start that the clamp must
/// have moved, else hold.
pub(super) fn phases(rows: impl Iterator<Item = (usize, f64)> + Clone) -> BTreeMap<usize, Phase> {
    let threshold = threshold(rows.clone().map(|(_, extension)| extension));
    let mut ends: BTreeMap<usize, [f64; 2]> = BTreeMap::new();
    for (branch, extension) in rows {
        ends.entry(branch).or_insert([extension; 2])[1] = extension;
    }
    let phase = |[first, last]: [f64; 2]| match last - first {
        rise if rise > threshold => Phase::Loading,
        rise if rise < -threshold => Phase::Unloading,
        _ => Phase::Hold,
    };
    ends.into_iter().map(|(branch, ends)| (branch, phase(ends))).collect()
}

fn threshold(extension: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = extension.fold((f64::MAX, f64::MIN), |(low, high), e| (low.min(e), high.max(e)));
    HYSTERESIS * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_branch_ends_where_the_extension_turns_back() {
        assert_eq!(numbered(&[0.0, 1.0, 2.0, 1.0, 0.0, 1.0]), [0, 0, 0, 1, 1, 2]);
        assert_eq!(numbered(&[2.0, 1.0, 0.0, 1.0]), [0, 0, 0, 1]);
        assert_eq!(numbered(&[0.0, 1.0, 1.0, 0.0]), [0, 0, 0, 1]);
        assert_eq!(numbered(&[1.0; 3]), [0; 3]);
        assert_eq!(numbered(&[1.0]), [0]);
        assert!(numbered(&[]).is_empty());
    }

    #[test]
    fn noise_does_not_split_a_branch() {
        // Up to 1, back to 0 and up to 1 in steps of 0.005, with an error of ±0.008 and slack at the start.
        let error = |row: usize| 0.008 * if row.is_multiple_of(2) { 1.0 } else { -1.0 };
        let path = |row: usize| [row, 400 - row.min(400), row.max(400) - 400][row / 200] as f64 * 0.005;
        let extension: Vec<_> = (0..600).map(|row| path(row) + error(row)).collect();
        let branches = numbered(&extension);
        assert!(branches.is_sorted());
        let count = |branch| branches.iter().filter(|&&b| b == branch).count() as isize;
        assert!((0..3).all(|branch| (count(branch) - 200).abs() <= 3), "{branches:?}");
        assert_eq!(branches.last(), Some(&2));
        let expected = [(0, Phase::Loading), (1, Phase::Unloading), (2, Phase::Loading)];
        assert_eq!(phases(branches.into_iter().zip(extension)), BTreeMap::from(expected));
    }

    #[test]
    fn a_branch_that_ends_where_it_began_is_a_hold() {
        let rows = [(0, 0.0), (0, 1.0), (1, 1.0), (1, 1.01), (2, 1.0), (2, 0.5)];
        let expected = [(0, Phase::Loading), (1, Phase::Hold), (2, Phase::Unloading)];
        assert_eq!(phases(rows.into_iter()), BTreeMap::from(expected));
    }
}
