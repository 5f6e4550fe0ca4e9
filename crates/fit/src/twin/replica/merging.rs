//! Merges the points of a cylinder: what thousands of them say of its few lines.
//!
//! ```text
//! simulated coordinates of m points   y = A z      z: coordinates of the L lines, place and tilt of the edge
//! AᵀA = V Λ Vᵀ      ‖y − A z‖² = ‖Λ^½ Vᵀ z − Λ^(−½) Vᵀ Aᵀ y‖² + what no cylinder meets
//! ```
//!
//! Rows of Λ^½ Vᵀ are points too: as many as lines, each with unit noise, and least squares on them is least squares on
//! all points. What is left is noise alone, and measures it.

use super::point::{MeasuredPoint, Term};
use faer::{Mat, Side};
use nalgebra::{DMatrix, DVector, Vector3};

/// Relative eigenvalue of AᵀA below which the points do not see a combination.
const UNSEEN: f64 = 1e-12;

/// The coordinates compared off a table: outward and up.
const AXES: [usize; 2] = [0, 2];

/// Points off a table, merged.
#[derive(Debug, Clone)]
pub struct Merging {
    /// The merged points.
    pub points: Vec<MeasuredPoint>,
    /// Sum of squares that no cylinder on this grid meets, m².
    pub left: f64,
    /// Its degrees of freedom.
    pub freedom: usize,
    /// Rows of A.
    rows: Vec<Vec<(usize, f64)>>,
    /// Λ^(−½) Vᵀ.
    back: DMatrix<f64>,
}

impl Merging {
    /// Merges points; `None` without eigenvalues: each then counts by itself.
    ///
    /// * `lines` — a term of weight 1 for every line
    pub(super) fn new(points: &[MeasuredPoint], lines: &[Term]) -> Option<Self> {
        let nodes: Vec<usize> = lines.iter().map(|line| line.node).collect();
        let columns = nodes.len() + 2;
        let mut square = DMatrix::zeros(columns, columns);
        let rows: Vec<Vec<(usize, f64)>> = points.iter().map(|point| row(&nodes, point)).collect();
        for row in &rows {
            for &(i, a) in row {
                row.iter().for_each(|&(j, b)| square[(i, j)] += a * b);
            }
        }
        // Columns of one length: tilts are per metre.
        let scale = DVector::from_fn(columns, |i, _| f64::max(square[(i, i)], f64::MIN_POSITIVE).sqrt());
        let scaled = Mat::from_fn(columns, columns, |i, j| square[(i, j)] / (scale[i] * scale[j]));
        // nalgebra's is not finite where many lines have no point.
        let eigen = scaled.self_adjoint_eigen(Side::Lower).ok()?;
        let (values, vectors) = (eigen.S().column_vector(), eigen.U());
        let largest = (0..columns).map(|i| values[i]).fold(0.0, f64::max);
        let seen: Vec<usize> = (0..columns).filter(|&i| values[i] > UNSEEN * largest).collect();
        let weight = |i: usize, j: usize| vectors[(j, seen[i])] * values[seen[i]].sqrt() * scale[j];
        let back = DMatrix::from_fn(seen.len(), columns, |i, j| {
            vectors[(j, seen[i])] / (values[seen[i]].sqrt() * scale[j])
        });
        let merged = |i: usize| MeasuredPoint {
            source: i,
            terms: lines.iter().enumerate().map(|(j, line)| Term { weight: weight(i, j), ..*line }).collect(),
            place: weight(i, nodes.len()),
            across: weight(i, nodes.len() + 1),
            position: Vector3::zeros(),
            spread: 1.0,
        };
        let merged = (0..seen.len()).map(merged).collect();
        let freedom = AXES.len() * points.len().saturating_sub(seen.len());
        let mut merging = Self { points: merged, left: 0.0, freedom, rows, back };
        let (positions, left) = merging.of(|point, axis| points[point].position[axis]);
        merging.left = left;
        for (point, position) in merging.points.iter_mut().zip(positions) {
            AXES.iter().zip(position).for_each(|(&axis, value)| point.position[axis] = value);
        }
        Some(merging)
    }

    /// Merges a value of every point and axis; returns those of the merged points, outward and up, and the sum of squares
    /// left.
    pub fn of(&self, value: impl Fn(usize, usize) -> f64) -> (Vec<[f64; 2]>, f64) {
        let mut found = vec![[0.0; 2]; self.points.len()];
        let mut left = 0.0;
        for (side, axis) in AXES.into_iter().enumerate() {
            let mut product = DVector::zeros(self.back.ncols());
            let mut square = 0.0;
            for (index, row) in self.rows.iter().enumerate() {
                let value = value(index, axis);
                square += value * value;
                row.iter().for_each(|(i, a)| product[*i] += a * value);
            }
            let merged = &self.back * product;
            left += (square - merged.norm_squared()).max(0.0);
            found.iter_mut().zip(merged.iter()).for_each(|(found, value)| found[side] = *value);
        }
        (found, left)
    }
}

/// A point's row of A.
fn row(nodes: &[usize], point: &MeasuredPoint) -> Vec<(usize, f64)> {
    let lines = point.terms.iter().filter_map(|term| {
        let line = nodes.iter().position(|&node| node == term.node)?;
        Some((line, term.weight))
    });
    lines.chain([(nodes.len(), point.place), (nodes.len() + 1, point.across)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::twin::replica::point::lagrange;

    /// Points of 12 places along a sheet of 41 lines, 7 across each.
    fn points() -> (Vec<MeasuredPoint>, Vec<Term>) {
        let term = |(node, weight): (usize, f64)| Term { node, weight, unknowns: [None; 3] };
        let point = |i: usize| MeasuredPoint {
            source: i,
            terms: lagrange(0.7 + 3.3 * (i / 7) as f64, 41).into_iter().map(term).collect(),
            place: 1.0,
            across: 0.01 * (i % 7) as f64 - 0.03,
            position: Vector3::new((1.3 * i as f64).sin(), 0.0, (0.7 * i as f64).cos()),
            spread: 1.0,
        };
        ((0..84).map(point).collect(), (0..41).map(|line| term((line, 1.0))).collect())
    }

    #[test]
    fn merged_points_have_the_same_squares() {
        let (points, lines) = points();
        let merging = Merging::new(&points, &lines).unwrap();
        let x: Vec<f64> = (0..123).map(|i| 0.1 * (0.4 * i as f64).sin()).collect();
        let squares = |points: &[MeasuredPoint]| -> f64 {
            let of = |point: &MeasuredPoint, axis: usize| {
                let shift = [0.02, -0.05][axis / 2] * point.place + 0.3 * point.across;
                (point.position[axis] - point.coordinate(&x, axis) - shift).powi(2)
            };
            points.iter().flat_map(|point| AXES.map(|axis| of(point, axis))).sum()
        };
        let [all, merged] = [squares(&points), squares(&merging.points)];
        assert!((all - merged - merging.left).abs() < 1e-10 * all, "{all} {merged} {}", merging.left);
        // One place tells a line, place and tilt of the edge add the tilt: the place is not told apart.
        assert_eq!(merging.points.len(), 13);
        assert_eq!(merging.freedom, 2 * (84 - 13));
        assert!(merging.left > 0.1 * all);
    }

    #[test]
    fn most_lines_may_have_no_point() {
        let term = |(node, weight): (usize, f64)| Term { node, weight, unknowns: [None; 3] };
        let lines: Vec<Term> = (0..194).map(|line| term((line, 1.0))).collect();
        let (points, _) = points();
        let moved = |(i, point): (usize, MeasuredPoint)| MeasuredPoint {
            terms: lagrange(6.4 + 31.7 * (i / 14) as f64, 194).into_iter().map(term).collect(),
            ..point
        };
        let merging =
            Merging::new(&points.into_iter().enumerate().map(moved).collect::<Vec<_>>(), &lines).unwrap();
        assert_eq!(merging.points.len(), 7);
        let weights = merging.points.iter().flat_map(|point| &point.terms).map(|term| term.weight);
        assert!(weights.chain([merging.left]).all(f64::is_finite) && merging.left > 0.0);
    }
}
