//! A problem of many unknowns with few in each row, to the accuracy of the interior-point method alone.
//!
//! The polish of [`LeastSquares::solve`] works on dense matrices and takes minutes for 200 unknowns under thousands
//! of rows. This takes a fraction of a second, where a few digits suffice.

use super::LeastSquares;
use super::interior_point::{Program, SolverStatus};
use super::scaled::unit_or;
use nalgebra::{DMatrix, DVector};

impl LeastSquares {
    /// The minimiser to about 1e-5 of its size, without polish; the method decides directions that the data do not
    /// see. `smoothing` has no effect. `None` if the method finds no solution.
    ///
    /// With p = ℓ x/norms, t = J p/ℓ and rows of unit length:
    ///
    /// ```text
    /// minimise ½ ‖t‖² − (y/ℓ)·t   subject to   J x/norms − t = 0,  A x/norms ≥ b/ℓ        ℓ = max(|y|, |b|)
    /// ```
    ///
    /// # Panics
    /// On inconsistent shapes.
    pub fn solve_unpolished(&self) -> Option<DVector<f64>> {
        let (m, n) = self.jacobian.shape();
        assert_eq!(
            (m, n),
            (self.target.len(), self.lower.len()),
            "a row for every target, a column for every unknown"
        );
        if !self.is_finite() {
            return None;
        }
        let mut norms = DVector::from_iterator(n, self.jacobian.column_iter().map(|column| column.norm()));
        // A column that appears only in the rows is scaled by the mean column norm.
        let typical = unit_or(norms.mean());
        norms.iter_mut().filter(|norm| **norm == 0.0).for_each(|norm| *norm = typical);
        let (_, mut rows, mut bounds) = self.inequalities();
        let mut jacobian = self.jacobian.clone();
        for (j, &norm) in norms.iter().enumerate() {
            jacobian.column_mut(j).unscale_mut(norm);
            rows.column_mut(j).unscale_mut(norm);
        }
        for (i, bound) in bounds.iter_mut().enumerate() {
            let norm = unit_or(rows.row(i).norm());
            rows.row_mut(i).unscale_mut(norm);
            *bound /= norm;
        }
        let kept: Vec<usize> = (0..bounds.len()).filter(|&i| bounds[i] > f64::NEG_INFINITY).collect();
        let length = unit_or(kept.iter().map(|&i| bounds[i].max(0.0)).fold(self.target.amax(), f64::max));
        let mut system = DMatrix::zeros(m + kept.len(), n + m);
        system.view_mut((0, 0), (m, n)).copy_from(&jacobian);
        system.view_mut((0, n), (m, m)).fill_diagonal(-1.0);
        kept.iter().enumerate().for_each(|(place, &i)| {
            system.view_mut((m + place, 0), (1, n)).copy_from(&-rows.row(i));
        });
        let right: Vec<f64> = (0..m).map(|_| 0.0).chain(kept.iter().map(|&i| -bounds[i] / length)).collect();
        let curvature: Vec<f64> = (0..n + m).map(|i| if i < n { 0.0 } else { 1.0 }).collect();
        let slope: Vec<f64> =
            (0..n + m).map(|i| if i < n { 0.0 } else { -self.target[i - n] / length }).collect();
        let program =
            Program { curvature: &curvature, slope: &slope, system: &system, right: &right, equations: m };
        let (point, _, status) = program.solve()?;
        let solved = matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        let point = DVector::from_fn(n, |j, _| point[j] * length / norms[j]);
        (solved && point.iter().all(|value| value.is_finite())).then_some(point)
    }
}
