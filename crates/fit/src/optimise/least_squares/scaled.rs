//! One least-squares problem with unit columns and unit rows, and the distance of a point from its solution.

use super::dense::{RANK_TOLERANCE, Spectrum, Triangle};
use super::kkt::{Held, Kkt};
use nalgebra::{DMatrix, DVector};

/// Minimises ½‖R q − c‖² subject to G q ≥ h, with `q = norms ∘ p`: the columns of R and the rows of G have unit
/// length.
pub(super) struct Scaled {
    /// R, n×n.
    pub(super) matrix: DMatrix<f64>,
    /// c.
    pub(super) target: DVector<f64>,
    /// Lengths of the original columns, 1 for a zero one.
    pub(super) norms: DVector<f64>,
    /// G.
    pub(super) rows: DMatrix<f64>,
    /// h.
    pub(super) bounds: DVector<f64>,
    /// Index and length of the original row of each row of G.
    pub(super) origin: Vec<(usize, f64)>,
    /// Singular values of R.
    pub(super) spectrum: Spectrum,
    /// Singular values up to this count as zero.
    pub(super) threshold: f64,
    /// True if a zero row requires a positive bound.
    pub(super) impossible: bool,
}

impl Scaled {
    pub(super) fn new(
        jacobian: &DMatrix<f64>,
        target: &DVector<f64>,
        rows: &DMatrix<f64>,
        bounds: &DVector<f64>,
    ) -> Self {
        let n = jacobian.ncols();
        let norms = DVector::from_iterator(n, jacobian.column_iter().map(|column| unit_or(column.norm())));
        let mut jacobian = jacobian.clone();
        jacobian.column_iter_mut().zip(norms.iter()).for_each(|(mut column, &norm)| column /= norm);
        let Triangle { matrix, target, .. } = Triangle::reduce(&jacobian, target);

        let scaled = DMatrix::from_fn(rows.nrows(), n, |i, j| rows[(i, j)] / norms[j]);
        let lengths: Vec<f64> = scaled.row_iter().map(|row| row.norm()).collect();
        let bounded = |i: usize| bounds[i] > f64::NEG_INFINITY;
        let origin: Vec<(usize, f64)> =
            lengths.iter().copied().enumerate().filter(|&(i, length)| bounded(i) && length > 0.0).collect();
        let spectrum = Spectrum::of(&matrix);
        Self {
            rows: DMatrix::from_fn(origin.len(), n, |i, j| scaled[(origin[i].0, j)] / origin[i].1),
            bounds: DVector::from_iterator(
                origin.len(),
                origin.iter().map(|&(i, length)| bounds[i] / length),
            ),
            impossible: (0..rows.nrows()).any(|i| lengths[i] == 0.0 && bounds[i] > 0.0),
            threshold: RANK_TOLERANCE * spectrum.values.iter().copied().fold(0.0, f64::max),
            matrix,
            target,
            norms,
            origin,
            spectrum,
        }
    }

    pub(super) fn columns(&self) -> usize {
        self.matrix.ncols()
    }

    pub(super) fn rank(&self) -> usize {
        self.spectrum.rank(self.threshold)
    }

    /// Directions that the system does not see, as unit columns, in the unscaled variables.
    pub(super) fn null_vectors(&self) -> DMatrix<f64> {
        let rank = self.rank();
        let mut vectors = self.spectrum.right.columns(rank, self.columns() - rank).into_owned();
        for mut vector in vectors.column_iter_mut() {
            vector.component_div_assign(&self.norms);
            let norm = unit_or(vector.norm());
            vector /= norm;
        }
        vectors
    }

    pub(super) fn along(&self, row: usize, step: &DVector<f64>) -> f64 {
        (0..step.len()).map(|j| self.rows[(row, j)] * step[j]).sum()
    }

    pub(super) fn slack(&self, row: usize, point: &DVector<f64>) -> f64 {
        self.along(row, point) - self.bounds[row]
    }

    /// The size of the numbers that cancel in the slack of a row, including those of the target: a solution that the
    /// rows press to zero is known only to their rounding.
    pub(super) fn size(&self, row: usize, point: &DVector<f64>) -> f64 {
        unit_or(point.amax() + self.bounds[row].abs() + self.target.amax())
    }

    /// Relative violation of a row; 0 if it holds.
    pub(super) fn violation(&self, row: usize, point: &DVector<f64>) -> f64 {
        (-self.slack(row, point)).max(0.0) / self.size(row, point)
    }

    /// Rᵀ(R q − c).
    pub(super) fn gradient(&self, point: &DVector<f64>) -> DVector<f64> {
        self.matrix.tr_mul(&(&self.matrix * point - &self.target))
    }

    /// The size of the terms that cancel in the gradient at a solution.
    pub(super) fn gradient_scale(&self, point: &DVector<f64>) -> f64 {
        unit_or(self.target.norm() + point.norm())
    }

    pub(super) fn kkt(&self, held: &Held) -> Kkt {
        let scale = self.gradient_scale(&held.point);
        let pull = self.rows.tr_mul(&held.multipliers);
        let over_rows =
            |figure: &dyn Fn(usize) -> f64| (0..self.rows.nrows()).map(figure).fold(0.0, f64::max);
        Kkt {
            stationarity: (self.gradient(&held.point) - pull).amax() / scale,
            primal: over_rows(&|row| self.violation(row, &held.point)),
            dual: over_rows(&|row| -held.multipliers[row] / scale),
            complementarity: over_rows(&|row| {
                let size = self.size(row, &held.point);
                (held.multipliers[row] * self.slack(row, &held.point)).abs() / scale / size
            }),
        }
    }
}

/// A scale to divide by: the value itself, or 1 if it is zero.
pub(super) fn unit_or(value: f64) -> f64 {
    if value == 0.0 { 1.0 } else { value }
}
