//! Lines of a grid along one side, some of them where clips end.
//!
//! ```text
//!  0   1    2    3    4    5   6      evenly spaced but for those moved to the ends of clips
//!  │   │    │    │    │    │   │
//!  └─ ─┼────┼────┼────┼────┼─ ─┘      side of the sheet
//!      ▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀▀          clip
//! ```
//!
//! A clip that ended between two lines would hold too much or too little cloth, by an amount that jumps with the grid.

/// Ends nearer to each other, or to the border, than this share of a cell fall together.
const TOGETHER: f64 = 0.25;

/// Lines closer than this, as a share of the side, coincide up to rounding.
const TIE: f64 = 1e-8;

/// Coordinates of the lines along one side, ascending from 0, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Lines(Vec<f64>);

impl Lines {
    /// Lines of `cells` cells over a length, m, through given places where there are lines enough.
    pub(super) fn new(length: f64, cells: usize, ends: &[f64]) -> Self {
        let cell = length / cells as f64;
        let mut ends: Vec<f64> = ends
            .iter()
            .copied()
            .filter(|&end| end > TOGETHER * cell && length - end > TOGETHER * cell)
            .collect();
        ends.sort_by(f64::total_cmp);
        // The mean of ends that fall together.
        let mut groups: Vec<Vec<f64>> = Vec::new();
        for end in ends {
            match groups.last_mut() {
                Some(group) if end - group[0] < TOGETHER * cell => group.push(end),
                _ => groups.push(vec![end]),
            }
        }
        let mut fixed = vec![(0, 0.0)];
        let count = groups.len();
        for (index, group) in groups.into_iter().enumerate() {
            let place = group.iter().sum::<f64>() / group.len() as f64;
            let [least, most] = [fixed[fixed.len() - 1].0 + 1, (cells + index).saturating_sub(count)];
            if least <= most {
                fixed.push((((place / cell).round() as usize).clamp(least, most), place));
            }
        }
        fixed.push((cells, length));
        let mut lines = vec![0.0];
        for pair in fixed.windows(2) {
            let ((from, low), (to, high)) = (pair[0], pair[1]);
            lines.extend((1..=to - from).map(|i| low + (high - low) * i as f64 / (to - from) as f64));
        }
        Self(lines)
    }

    /// Every cell cut into as many.
    pub(super) fn refined(&self, into: usize) -> Self {
        let cut = |pair: &[f64]| {
            let [low, high] = [pair[0], pair[1]];
            (1..=into).map(move |i| low + (high - low) * i as f64 / into as f64).collect::<Vec<_>>()
        };
        Self([0.0].into_iter().chain(self.0.windows(2).flat_map(cut)).collect())
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.0.len() - 1
    }

    /// Coordinate at a number of lines that need not be whole, m.
    pub(super) fn at(&self, line: f64) -> f64 {
        let first = (line.floor().max(0.0) as usize).min(self.cells() - 1);
        let share = line - first as f64;
        self.0[first] * (1.0 - share) + self.0[first + 1] * share
    }

    /// Coordinates of the lines nearest to a place, of two if they are equally near, m.
    pub(super) fn nearest(&self, place: f64) -> [f64; 2] {
        let distance = |line: &&f64| (*line - place).abs();
        let least = self.0.iter().map(|line| distance(&line)).fold(f64::MAX, f64::min);
        let tie = TIE * self.0[self.cells()];
        let near = self.0.iter().filter(|line| distance(line) <= least + tie).copied();
        near.fold([f64::MAX, f64::MIN], |[low, high], line| [low.min(line), high.max(line)])
    }

    /// Rounding of coordinates, m.
    pub(super) fn tie(&self) -> f64 {
        TIE * self.0[self.cells()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_even_but_for_those_where_clips_end() {
        let close = |lines: &Lines, expected: &[f64]| {
            assert_eq!(lines.0.len(), expected.len());
            lines.0.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{lines:?}"));
        };
        close(&Lines::new(4.0, 4, &[]), &[0.0, 1.0, 2.0, 3.0, 4.0]);
        close(&Lines::new(4.0, 4, &[0.4, 3.6]), &[0.0, 0.4, 2.0, 3.6, 4.0]);
        // Two clips that end a little apart; one that ends at the border.
        close(&Lines::new(4.0, 4, &[1.1, 1.2, 3.9]), &[0.0, 1.15, 2.1, 3.05, 4.0]);
        // More ends than lines.
        close(&Lines::new(2.0, 2, &[0.4, 1.0, 1.6]), &[0.0, 1.6, 2.0]);
        close(&Lines::new(4.0, 2, &[0.6]).refined(2), &[0.0, 0.3, 0.6, 2.3, 4.0]);
    }

    #[test]
    fn a_place_has_the_lines_nearest_to_it() {
        let lines = Lines::new(4.0, 4, &[0.4]);
        assert_eq!(lines.nearest(0.3), [0.4; 2]);
        assert_eq!(lines.nearest(0.2), [0.0, 0.4]);
        assert_eq!(lines.at(0.5), 0.2);
    }
}
