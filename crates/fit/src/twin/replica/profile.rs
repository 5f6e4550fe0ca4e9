//! The measured profile of a sheet that bends as a cylinder: a polyline of medians over its points, across the sheet.

use nalgebra::Vector2;

/// Fewest points of a bin.
const BIN: usize = 5;

/// A point farther off the profile than this multiple of the median distance is a stray: 9 standard deviations of
/// noise. Distances up to rounding, m, are not.
const STRAY: f64 = 6.0;
const ROUNDING: f64 = 1e-9;

/// Distance along the sheet at rest, and position in the plane across the edge, outward and up, m.
pub(super) type Along = (f64, Vector2<f64>);

/// Medians in ascending order of the distance along the sheet.
#[derive(Debug, Clone)]
pub(super) struct Profile(Vec<Along>);

impl Profile {
    /// Through points in any order. Points at the same distance share a bin; sparse ones are joined.
    pub(super) fn new(mut points: Vec<Along>) -> Self {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let length = points.last().map_or(0.0, |last| last.0 - points[0].0);
        // Rows of a regular mesh agree up to rounding of the file.
        let same = 1e-4 * length;
        let mut bins: Vec<Vec<Along>> = Vec::new();
        for point in points {
            match bins.last_mut() {
                Some(bin) if bin.len() < BIN || point.0 - bin[0].0 <= same => bin.push(point),
                _ => bins.push(vec![point]),
            }
        }
        Self(bins.iter().map(|bin| middle(bin)).collect())
    }

    /// Number of medians.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The median with an index.
    pub(super) fn median(&self, index: usize) -> Along {
        self.0[index]
    }

    /// Index of the first median past the edge, x > 0.
    pub(super) fn first_past(&self) -> Option<usize> {
        self.0.iter().position(|(_, place)| place.x > 0.0)
    }

    /// The position at a distance, on the polyline or the extension of its end segments.
    pub(super) fn at(&self, s: f64) -> Vector2<f64> {
        let after = self.0.partition_point(|(at, _)| *at < s).clamp(1, (self.0.len() - 1).max(1));
        match (self.0.get(after - 1), self.0.get(after)) {
            (Some((from, a)), Some((to, b))) => a + (b - a) * ((s - from) / (to - from)),
            (Some((_, only)), None) => *only,
            _ => Vector2::zeros(),
        }
    }

    /// Which of some points are far off the profile. Bends between medians are allowed for.
    pub(super) fn strays(&self, points: &[Along]) -> Vec<bool> {
        let distances: Vec<f64> = points.iter().map(|(s, place)| (place - self.at(*s)).norm()).collect();
        let mut sorted = distances.clone();
        sorted.sort_by(f64::total_cmp);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let limit = f64::max(STRAY * median, ROUNDING) + self.sag();
        distances.iter().map(|distance| *distance > limit).collect()
    }

    /// Largest height of the arc over a segment, m: an eighth of the second difference.
    fn sag(&self) -> f64 {
        let bend = |three: &[Along]| (three[0].1 - 2.0 * three[1].1 + three[2].1).norm() / 8.0;
        self.0.windows(3).map(bend).fold(0.0, f64::max)
    }
}

/// Medians of every coordinate.
fn middle(bin: &[Along]) -> Along {
    let median = |of: &dyn Fn(&Along) -> f64| {
        let mut values: Vec<f64> = bin.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        let half = values.len() / 2;
        if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) }
    };
    (median(&|p| p.0), Vector2::new(median(&|p| p.1.x), median(&|p| p.1.y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_point_of_a_row_that_was_seen_elsewhere_moves_nothing() {
        let row = |s: f64| (0..6).map(move |_| (s, Vector2::new(s, -s * s)));
        let mut points: Vec<Along> = (0..30).flat_map(|i| row(0.002 * f64::from(i))).collect();
        points[80].1.y += 0.02;
        let profile = Profile::new(points.clone());
        assert_eq!(profile.len(), 30);
        assert!((profile.at(0.025) - Vector2::new(0.025, -0.000625)).norm() < 2e-6);
        let strays = profile.strays(&points);
        assert!(strays[80] && strays.iter().filter(|&&stray| stray).count() == 1);
    }

    #[test]
    fn scattered_points_make_bins_of_their_own() {
        let points: Vec<Along> =
            (0..97).map(|i| f64::from(i * 37 % 97) * 1e-3).map(|s| (s, Vector2::new(s, 0.0))).collect();
        let profile = Profile::new(points);
        assert!(profile.len() >= 19 && (profile.at(0.05) - Vector2::new(0.05, 0.0)).norm() < 1e-12);
    }
}
